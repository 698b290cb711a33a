/** The picture on the page: image, object numbers and, where the answer is told, an outline. */

import type { AnswerValue } from "./api";
import { element } from "./dom";
import { message } from "./messages";
import { fitImage, numberPlaces } from "./placement";
import { BACKGROUND, type Regions } from "./regions";
import type { Exhibit, Stimulus } from "./stimulus";

/** The side of a number and its distance from its object, in CSS pixels. */
const NUMBER_SIZE = 20;
const NUMBER_GAP = 2;

/** Shows one stimulus in an area of the page and keeps it in place when the window changes. */
export class Stage implements Exhibit<AnswerValue> {
  /** The area; the picture is centred in it. */
  readonly area = element("div", { class: "stage" });
  /** The number buttons by label. */
  readonly numbers = new Map<number, HTMLButtonElement>();
  private readonly regions: Regions;
  private readonly picture: HTMLElement;
  private readonly outlines = new Map<number, SVGSVGElement>();
  private readonly stopListening = new AbortController();

  constructor({ image, regions }: Stimulus, choices: number) {
    if (regions === null) {
      throw new Error("a stage needs an image with regions");
    }
    this.regions = regions;
    image.alt = message("trial.image", { choices });
    image.draggable = false;
    this.picture = element("div", { class: "picture" }, image);
    this.addNumbers();
    this.picture.addEventListener("pointermove", (event) => this.markHovered(event));
    this.picture.addEventListener("pointerleave", () => this.highlight(BACKGROUND));
    this.area.append(this.picture);
    window.addEventListener("resize", () => this.place(), { signal: this.stopListening.signal });
  }

  /** Put the picture in its place; call it once the area is on the page. */
  place(): void {
    const area = this.area.getBoundingClientRect();
    const shown = fitImage(this.regions, area, window.devicePixelRatio);
    this.picture.style.left = `${shown.left - area.left}px`;
    this.picture.style.top = `${shown.top - area.top}px`;
    this.picture.style.width = `${shown.width}px`;
    this.picture.style.height = `${shown.height}px`;
    this.placeNumbers(shown.width / this.regions.width_px);
  }

  /** Hide or show the picture without moving anything. */
  setVisible(visible: boolean): void {
    this.picture.classList.toggle("hidden", !visible);
  }

  /** Return the label that a pointer event points at: a region or its number. */
  labelOf(event: PointerEvent): number {
    for (const [label, button] of this.numbers) {
      if (event.target instanceof Node && button.contains(event.target)) {
        return label;
      }
    }
    const shown = this.picture.getBoundingClientRect();
    return this.regions.labelUnder(event.clientX, event.clientY, shown);
  }

  /** Draw the outline of a region, or of several. */
  mark(answer: AnswerValue): void {
    for (const label of [answer].flat()) {
      this.setOutlined(label, true);
    }
  }

  /** Draw or remove the outline of a region. */
  setOutlined(label: number, outlined: boolean): void {
    this.outlines.get(label)?.remove();
    this.outlines.delete(label);
    if (outlined) {
      const outline = this.outlineOf(label);
      this.outlines.set(label, outline);
      this.picture.append(outline);
    }
  }

  /** Stop following the window. */
  dispose(): void {
    this.stopListening.abort();
  }

  private outlineOf(label: number): SVGSVGElement {
    const { regions } = this;
    const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
    svg.setAttribute("viewBox", `0 0 ${regions.width_px} ${regions.height_px}`);
    svg.setAttribute("preserveAspectRatio", "none");
    svg.setAttribute("class", "outline");
    svg.setAttribute("aria-hidden", "true");
    for (const className of ["outline-halo", "outline-line"]) {
      const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
      path.setAttribute("d", regions.outline(label));
      path.setAttribute("class", className);
      svg.append(path);
    }
    return svg;
  }

  private addNumbers(): void {
    for (const label of [...this.regions.boxes().keys()].sort((a, b) => a - b)) {
      const name = message("trial.number", { label });
      const button = element("button", { class: "number", type: "button", "aria-label": name });
      button.append(String(label));
      this.numbers.set(label, button);
      this.picture.append(button);
    }
  }

  private placeNumbers(scale: number): void {
    const { regions } = this;
    for (const [label, { x, y }] of numberPlaces(
      regions,
      NUMBER_SIZE / scale,
      NUMBER_GAP / scale,
    )) {
      const button = this.numbers.get(label);
      if (button !== undefined) {
        button.style.left = `${(100 * x) / regions.width_px}%`;
        button.style.top = `${(100 * y) / regions.height_px}%`;
      }
    }
  }

  /** The cue is the same for every object and changes nothing within the image. */
  private markHovered(event: PointerEvent): void {
    this.highlight(event.pointerType === "mouse" ? this.labelOf(event) : BACKGROUND);
  }

  private highlight(hovered: number): void {
    this.picture.classList.toggle("over-object", hovered !== BACKGROUND);
    for (const [label, button] of this.numbers) {
      button.classList.toggle("hovered", label === hovered);
    }
  }
}
