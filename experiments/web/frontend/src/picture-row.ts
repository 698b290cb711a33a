/** Images side by side at one scale, or one after the other in one place. */

import { element } from "./dom";
import { message } from "./messages";
import { fitGrid, type Size } from "./placement";
import type { Exhibit, Stimulus } from "./stimulus";

const GAP_SHARE = 0.02;
const LEAST_GAP = 8;

/** Return the distance between images that are shown at once, in CSS pixels. */
export function gapOf(area: { width: number }): number {
  return Math.max(LEAST_GAP, GAP_SHARE * area.width);
}

/** Something that fills a picture's place: an image, or a mask. */
export interface Content extends Size {
  content: HTMLElement;
}

/**
 * Return an image as the content of a place.
 *
 * @param name - What it is called to who does not see it.
 */
export function pictureOf({ image, width_px, height_px }: Stimulus, name: string): Content {
  image.alt = name;
  image.draggable = false;
  return { content: image, width_px, height_px };
}

/** Shows images in an area of the page and keeps them in place when the window changes. */
export class PictureRow implements Exhibit<number> {
  /** The area; the row is centred in it. */
  readonly area = element("div", { class: "stage" });
  private readonly pictures: HTMLElement[];
  private readonly stopListening = new AbortController();

  /** @param inTurn - Give all the same place; at most one is to be visible at a time. */
  constructor(
    private readonly contents: Content[],
    private readonly inTurn = false,
  ) {
    this.pictures = contents.map(({ content }) => element("div", { class: "picture" }, content));
    this.area.append(...this.pictures);
    window.addEventListener("resize", () => this.place(), { signal: this.stopListening.signal });
  }

  place(): void {
    const area = this.area.getBoundingClientRect();
    const columns = this.inTurn ? 1 : this.pictures.length;
    const grid = { columns, gap: gapOf(area), caption: 0 };
    const groups = this.inTurn ? this.contents.map((content) => [content]) : [this.contents];
    const places = groups.flatMap((group) => fitGrid(group, area, window.devicePixelRatio, grid));
    for (const [index, shown] of places.entries()) {
      const picture = this.pictures[index] as HTMLElement;
      picture.style.left = `${shown.left - area.left}px`;
      picture.style.top = `${shown.top - area.top}px`;
      picture.style.width = `${shown.width}px`;
      picture.style.height = `${shown.height}px`;
    }
  }

  /** Let a press on a picture choose it, and show under the pointer that it does. */
  letChoose(): void {
    this.area.classList.add("choosable");
  }

  /** Show the pictures of these places, counted from 1, and hide the others. */
  show(...places: number[]): void {
    for (const [index, picture] of this.pictures.entries()) {
      picture.classList.toggle("hidden", !places.includes(index + 1));
    }
  }

  /** Show all pictures. */
  showAll(): void {
    this.show(...this.pictures.map((_, index) => index + 1));
  }

  /** Return the place, from 1, of the picture that a pointer event points at; 0 for none. */
  placeOf(event: PointerEvent): number {
    const { target } = event;
    return 1 + this.pictures.findIndex((each) => target instanceof Node && each.contains(target));
  }

  /** Put a frame around the picture of a place. */
  mark(place: number): void {
    this.pictures[place - 1]?.classList.add("marked");
  }

  dispose(): void {
    this.stopListening.abort();
  }
}

/** Return the two images of a pair, side by side. */
export function pairRow(stimuli: [Stimulus, Stimulus]): PictureRow {
  const names = pairNames(false);
  return new PictureRow(stimuli.map((stimulus, index) => pictureOf(stimulus, names[index] ?? "")));
}

/** What the two images of a pair are called. */
export function pairNames(inTurn: boolean): [string, string] {
  return inTurn
    ? [message("pair.first"), message("pair.second")]
    : [message("pair.left"), message("pair.right_image")];
}
