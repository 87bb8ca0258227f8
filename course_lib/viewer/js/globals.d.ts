// What meshcat's bundle brings; it has no types of its own.
declare const MeshCat: any;
declare const THREE: any;
// Not yet known to TypeScript 4.
declare var DecompressionStream: any;
// The text of panels/panels.css.
declare const PANEL_STYLE: string;
