// The plain data that server (marking_queue.py, server.py) and page exchange.

export type Item = {
  key: string; student: string; exercise: string; task: string; title: string; alias: string; score: number; points: number;
  state: "waiting" | "marked" | "checks"; failed: string[]; note: string; revision: string;
};
export type Mark = { task: string; points: number | null; row: string; comment: string; by: string; at: string };
export type Check = { title: string; scenario: string; is_hidden: boolean; score: number; message: string; mistake: string; broken: string };
export type Cell = { title: string; own: boolean; pieces: [string, string][] };
export type Details = Item & {
  rubric: { text: string; points: number }[]; whole: boolean; marks: Mark[]; checks: Check[]; errors: string[];
  used: [string, string][]; code: { cells: Cell[]; problem: string }; scene: string; others: Record<string, string>;
};
export type Changes = { number: number; items: Item[]; problems: string[]; others: Record<string, string>; state: string };
export type MarkEntry = { row: string; points: number | null; comment: string } | { row: string; withdraw: true };
export type Draft = { revision: string; fields: Record<string, string> };
