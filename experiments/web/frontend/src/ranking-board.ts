/** Images in numbered places, brought into order by dragging or from the keyboard. */

import { element } from "./dom";
import { message } from "./messages";
import { Order } from "./ordering";
import { gapOf, pictureOf } from "./picture-row";
import { fitGrid, type Rectangle } from "./placement";
import type { Exhibit, Stimulus } from "./stimulus";

/** The height of the line above each place, in CSS pixels. */
const CAPTION = 34;
/** How far the pointer moves before a press becomes a drag, in CSS pixels. */
const SLOP = 4;

/** What a board lets its user do. */
export interface BoardOptions {
  /** What the ends are called, best first. */
  ends: readonly [string, string];
  ties: boolean;
}

/** Shows images in places, best first. */
export class RankingBoard implements Exhibit<number[]> {
  readonly area = element("div", { class: "stage board" });
  /** Says to screen readers where an image went. */
  readonly status = element("p", { class: "unseen", role: "status" });
  private readonly pictures: HTMLButtonElement[];
  private readonly captions: HTMLElement[];
  private places: Rectangle[] = [];
  private order: Order;
  private held: number | null = null;
  private readonly listening = new AbortController();

  constructor(
    private readonly stimuli: Stimulus[],
    private readonly options: BoardOptions,
  ) {
    this.order = Order.asShown(stimuli.length);
    this.pictures = stimuli.map((stimulus) => {
      const { content } = pictureOf(stimulus, "");
      return element("button", { class: "picture ranked", type: "button" }, content);
    });
    this.captions = stimuli.map((_, place) => this.makeCaption(place));
    this.area.append(...this.captions, ...this.pictures);
    window.addEventListener("resize", () => this.place(), { signal: this.listening.signal });
    this.describe();
  }

  /** The rank of each image in the order shown. */
  get ranks(): number[] {
    return this.order.ranks();
  }

  /** Let the images be moved. */
  letMove(): void {
    const { signal } = this.listening;
    for (const [image, picture] of this.pictures.entries()) {
      picture.addEventListener("pointerdown", (event) => this.drag(event, image), { signal });
      picture.addEventListener("keydown", (event) => this.press(event, image), { signal });
      picture.addEventListener("blur", () => this.hold(null), { signal });
    }
  }

  place(): void {
    const area = this.area.getBoundingClientRect();
    const grid = { columns: null, gap: gapOf(area), caption: CAPTION };
    this.places = fitGrid(this.stimuli, area, window.devicePixelRatio, grid).map((shown) => ({
      ...shown,
      left: shown.left - area.left,
      top: shown.top - area.top,
    }));
    for (const [place, caption] of this.captions.entries()) {
      const { left, top, width } = this.places[place] as Rectangle;
      caption.style.left = `${left}px`;
      caption.style.top = `${top - CAPTION}px`;
      caption.style.width = `${width}px`;
      caption.style.height = `${CAPTION}px`;
    }
    this.layOut(this.order);
  }

  /** Hide or show the pictures without moving anything. */
  setVisible(visible: boolean): void {
    for (const picture of this.pictures) {
      picture.classList.toggle("hidden", !visible);
      picture.disabled = !visible;
    }
  }

  /** Bring the images into the order of these ranks, for good. */
  mark(ranks: number[]): void {
    const images = [...ranks.keys()].sort((a, b) => (ranks[a] ?? 0) - (ranks[b] ?? 0));
    this.order = new Order(images);
    this.layOut(this.order);
    this.describe();
  }

  dispose(): void {
    this.listening.abort();
  }

  private makeCaption(place: number): HTMLElement {
    const { ends, ties } = this.options;
    const end = place === 0 ? ends[0] : place === this.stimuli.length - 1 ? ends[1] : "";
    const caption = element("div", { class: "caption" }, element("span", { class: "rank" }), end);
    if (ties && place > 0) {
      const label = message("ranking.tie", { place: place + 1 });
      const tie = element("button", { class: "tie", type: "button", "aria-label": label }, "=");
      tie.addEventListener("click", () => this.changeTie(place));
      caption.append(tie);
    }
    return caption;
  }

  /** Put every picture into its place, but leave that which is being dragged under the pointer. */
  private layOut(order: Order, dragged: number | null = null): void {
    for (const [place, image] of order.images.entries()) {
      const picture = this.pictures[image];
      const { left, top, width, height } = this.places[place] as Rectangle;
      if (picture !== undefined && image !== dragged) {
        picture.style.left = `${left}px`;
        picture.style.top = `${top}px`;
      }
      if (picture !== undefined) {
        picture.style.width = `${width}px`;
        picture.style.height = `${height}px`;
      }
    }
  }

  /** Say in words what stands where. */
  private describe(): void {
    const total = this.stimuli.length;
    for (const [place, image] of this.order.images.entries()) {
      const rank = this.order.rankOfPlace(place);
      const label = message("ranking.image", { image: image + 1, rank, total });
      this.pictures[image]?.setAttribute("aria-label", label);
      const caption = this.captions[place];
      caption?.querySelector(".rank")?.replaceChildren(String(rank));
      caption?.querySelector(".tie")?.setAttribute("aria-pressed", String(rank <= place));
    }
  }

  private accept(order: Order, image: number): void {
    const focused = document.activeElement === this.pictures[image];
    this.order = order;
    this.layOut(order);
    this.describe();
    // Tab and screen readers follow the order of the elements.
    this.area.append(...order.images.map((each) => this.pictures[each] as HTMLElement));
    if (focused) {
      const { held } = this;
      this.pictures[image]?.focus();
      this.hold(held);
    }
    this.status.textContent = this.pictures[image]?.getAttribute("aria-label") ?? "";
  }

  private changeTie(place: number): void {
    this.order = this.order.withTieChanged(place);
    this.describe();
    const image = this.order.images[place] ?? 0;
    this.status.textContent = this.pictures[image]?.getAttribute("aria-label") ?? "";
  }

  private hold(image: number | null): void {
    this.held = image;
    for (const [index, picture] of this.pictures.entries()) {
      picture.classList.toggle("held", index === image);
      picture.setAttribute("aria-pressed", String(index === image));
    }
  }

  private press(event: KeyboardEvent, image: number): void {
    if (event.ctrlKey || event.altKey || event.metaKey) {
      return;
    }
    const place = this.order.images.indexOf(image);
    const last = this.stimuli.length - 1;
    const step = STEPS[event.key] ?? 0;
    const digit = Number(/^(?:Digit|Numpad)([1-9])$/.exec(event.code)?.[1] ?? 0);
    if (event.key === " " || event.key === "Enter") {
      this.hold(this.held === image ? null : image);
    } else if (event.key === "Escape") {
      this.hold(null);
    } else if (event.key === "=" && this.options.ties) {
      this.changeTie(place);
    } else if (digit > 0 && digit - 1 <= last) {
      this.accept(this.order.moved(place, digit - 1), image);
    } else if (step !== 0) {
      const target = Math.min(last, Math.max(0, place + step));
      if (this.held === image) {
        this.accept(this.order.moved(place, target), image);
      } else {
        this.pictures[this.order.images[target] ?? image]?.focus();
      }
    } else {
      return;
    }
    event.preventDefault();
  }

  private drag(down: PointerEvent, image: number): void {
    const picture = this.pictures[image];
    if (!down.isPrimary || down.button !== 0 || picture === undefined) {
      return;
    }
    const before = this.order;
    const source = before.images.indexOf(image);
    const start = this.places[source] as Rectangle;
    const done = new AbortController();
    const signal = AbortSignal.any([done.signal, this.listening.signal]);
    let target = source;
    const move = (event: PointerEvent) => {
      const [right, below] = [event.clientX - down.clientX, event.clientY - down.clientY];
      if (!picture.classList.contains("dragged") && Math.hypot(right, below) < SLOP) {
        return;
      }
      picture.classList.add("dragged");
      picture.style.left = `${start.left + right}px`;
      picture.style.top = `${start.top + below}px`;
      target = this.nearestPlace(start.left + right, start.top + below);
      this.layOut(before.moved(source, target), image);
    };
    const finish = (to: number) => {
      done.abort();
      picture.classList.remove("dragged");
      this.accept(before.moved(source, to), image);
    };
    picture.setPointerCapture(down.pointerId);
    picture.addEventListener("pointermove", move, { signal });
    picture.addEventListener("pointerup", () => finish(target), { signal });
    picture.addEventListener("pointercancel", () => finish(source), { signal });
  }

  private nearestPlace(left: number, top: number): number {
    const away = this.places.map((place) => Math.hypot(place.left - left, place.top - top));
    return away.indexOf(Math.min(...away));
  }
}

const STEPS: Record<string, number> = { ArrowLeft: -1, ArrowUp: -1, ArrowRight: 1, ArrowDown: 1 };
