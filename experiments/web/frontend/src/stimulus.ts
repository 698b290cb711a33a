/** What is shown: a decoded image. */

import type { Regions } from "./regions";

/** A decoded image with its size; with its regions where objects in it can be chosen. */
export interface Stimulus {
  image: HTMLImageElement;
  width_px: number;
  height_px: number;
  regions: Regions | null;
}

/** Something on the page that shows one or more images and can mark an answer. */
export interface Exhibit<Answer> {
  /** The part of the page that it fills. */
  readonly area: HTMLElement;
  /** Put everything in its place; call it once the area is on the page. */
  place(): void;
  /** Show which answer is right. */
  mark(answer: Answer): void;
  /** Stop following the window. */
  dispose(): void;
}
