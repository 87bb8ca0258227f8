// Generated from Python's messages: python -m tests.viewer.declarations

/** A click into a view; points are in the scene's frame, in [m]. */
export interface Click {
  path?: string;
  point?: [number, number, number];
  normal?: [number, number, number];
  index?: number;
  button?: number;
  origin: [number, number, number];
  direction: [number, number, number];
}

/** The rules by which a page moves a view when the user drags it. */
export interface DragRules {
  inPlace: boolean;
  aligned: boolean;
  locked: boolean;
  lift: number;
  ground: number;
  focalSize: number;
  focalFixed: boolean;
}

/** An entry of a context menu. An entry with a submenu cannot be chosen. */
export interface MenuItem {
  id: number;
  text: string;
  opens?: boolean;
}

/** The latest context menu of an interactive marker; each menu has a new number. */
export interface ContextMenu {
  number?: number;
  path?: string;
  entries?: MenuItem[];
}

/** The pointer acts on an interactive marker; points and rays are in the fixed frame [m]. */
export interface UseControl {
  path: string;
  event: string;
  button: number;
  origin: [number, number, number];
  direction: [number, number, number];
  eye: [number, number, number];
  target: [number, number, number];
  up: [number, number, number];
  scale: number;
  pixel: number;
  shift: boolean;
  ctrl: boolean;
  point?: [number, number, number];
}

/** Choose an entry of an interactive marker's menu. */
export interface ChooseEntry {
  path: string;
  entry: number;
}

/** The control of a row, and its limits. */
export interface Editor {
  kind: "bool" | "color" | "enum" | "frame" | "integer" | "none" | "number" | "text" | "topic" | "vector";
  low?: number;
  high?: number;
  options?: string[];
  type?: string;
}

/** A status level as an identifier, an icon and a word. */
export interface LevelMark {
  level: "ok" | "warn" | "error" | "hint";
  icon: string;
  word: string;
}

/** One row of a tree. */
export interface PanelRow {
  key: string;
  parent: string;
  label: string;
  text?: string;
  value?: any;
  checked?: boolean;
  open?: boolean;
  title?: string;
  mark?: LevelMark;
  editor?: Editor;
}

/** One button of the tool bar. */
export interface ToolButton {
  label: string;
  key: string;
  gesture: "interact" | "camera" | "select" | "focus" | "measure" | "pose" | "point";
}

/** The properties of tools that the page itself uses. */
export interface ToolSettings {
  single: boolean;
  color: string;
}

/** The type of the view, all types, and the names of the saved views. */
export interface ViewChoice {
  type: string;
  types: string[];
  saved: string[];
}

/** The worst status as a single line. */
export interface StatusLine {
  mark: LevelMark;
  text: string;
}

/** The response to the last command; the text is empty if there is none. */
export interface Notice {
  level?: "" | "ok" | "error";
  text?: string;
}

/** A class of display. */
export interface AddableType {
  name: string;
  short: string;
  about?: string;
}

/** A topic, and a class of display for it. */
export interface AddableTopic {
  topic: string;
  type: string;
  display: string;
}

/** The .rviz files in the notebook's folder, and the last used file. */
export interface Layouts {
  last: string;
  files: string[];
}

/** The whole state of the panels. `tree`, `view` and `tools` are the keys of their rows, parents first. */
export interface PanelState {
  tree: string[];
  view: string[];
  tools: string[];
  toolbar: ToolButton[];
  settings: ToolSettings;
  drag: DragRules;
  views: ViewChoice;
  status: StatusLine;
  notice: Notice;
  selection: string;
  types: AddableType[];
  topics: AddableTopic[];
  handles: string[];
  menu: ContextMenu;
  frames: string[];
  layouts: Layouts;
  summary: string;
}

/** The fields of the state and the rows that have changed, and the keys of removed rows. */
export interface PanelUpdate {
  changed: Partial<PanelState>;
  rows: Record<string, PanelRow>;
  gone: string[];
}

/** A new page requests the whole state. */
export interface OpenPanels {
}

/** Request an update. */
export interface RequestUpdate {
}

/** Start or stop requesting changed rows, because a panel was opened or closed. */
export interface WatchRows {
  watched: boolean;
}

/** Edit a row, or tick its box. */
export interface SetValue {
  row: string;
  value: any;
}

/** Add a display to the selected group. */
export interface AddDisplay {
  display: string;
  topic?: string;
  row?: string;
}

/** Add a copy of a display. */
export interface DuplicateDisplay {
  row: string;
}

/** Change the name of a display or group. */
export interface RenameRow {
  row: string;
  name: string;
}

/** Remove a display or group. */
export interface RemoveRow {
  row: string;
}

/** Write an .rviz file into the notebook's folder. */
export interface SaveLayout {
  name: string;
}

/** Open an .rviz file in the notebook's folder. */
export interface LoadLayout {
  name: string;
}

/** Change the type of view. */
export interface ChangeView {
  view: string;
}

/** Return to the defaults of the view. */
export interface HomeView {
}

/** Save the current view. */
export interface SaveView {
  name: string;
}

/** Switch to a saved view. */
export interface UseView {
  index: number;
}

/** Change the name of a saved view. */
export interface RenameView {
  index: number;
  name: string;
}

/** Remove a saved view. */
export interface RemoveView {
  index: number;
}

/** The user has moved the view; points are in the fixed frame [m]. */
export interface TurnView {
  eye: [number, number, number];
  target: [number, number, number];
  up: [number, number, number];
  scale: number;
}

/** An object or the background was clicked. */
export interface SelectObject {
  path?: string;
  index?: number;
}

/** A tool was used at a point in the fixed frame, [m], with an angle about z, [rad]. */
export interface PublishGesture {
  tool: string;
  point: [number, number, number];
  angle?: number;
}

/** The state of a time bar, [s]; wall time only for a live graph, the range only for a recording. */
export interface TimeState {
  elapsed: number;
  paused: boolean;
  rate: number;
  now?: number;
  range?: [number, number];
  wall?: number;
  wallElapsed?: number;
  loop?: boolean;
  note?: string;
}

/** A command of a time bar; without any field it requests the time. */
export interface TimeChange {
  now?: number;
  step?: number;
  rate?: number;
  loop?: boolean;
  paused?: boolean;
}

export type Command =
  | ({ act: "OpenPanels" } & OpenPanels)
  | ({ act: "RequestUpdate" } & RequestUpdate)
  | ({ act: "SetValue" } & SetValue)
  | ({ act: "AddDisplay" } & AddDisplay)
  | ({ act: "DuplicateDisplay" } & DuplicateDisplay)
  | ({ act: "RenameRow" } & RenameRow)
  | ({ act: "RemoveRow" } & RemoveRow)
  | ({ act: "SaveLayout" } & SaveLayout)
  | ({ act: "LoadLayout" } & LoadLayout)
  | ({ act: "ChangeView" } & ChangeView)
  | ({ act: "HomeView" } & HomeView)
  | ({ act: "SaveView" } & SaveView)
  | ({ act: "UseView" } & UseView)
  | ({ act: "RenameView" } & RenameView)
  | ({ act: "RemoveView" } & RemoveView)
  | ({ act: "TurnView" } & TurnView)
  | ({ act: "SelectObject" } & SelectObject)
  | ({ act: "PublishGesture" } & PublishGesture)
  | ({ act: "UseControl" } & UseControl)
  | ({ act: "ChooseEntry" } & ChooseEntry)
  | ({ act: "WatchRows" } & WatchRows);
