/**
 * How large the screen's pixels are, by a card held to it, and how far away the eye is, by its blind
 * spot: the virtual chinrest of Li et al. (2020), Scientific Reports 10, 904.
 */

import type { ScreenRules } from "../api";
import { element, pressed, showPage } from "../dom";
import { nextFrame } from "../frames";
import { message } from "../messages";

/** Bank cards, by ISO/IEC 7810 (ID-1). */
const CARD_MM = { long: 85.6, short: 53.98 };
const CARD_PX = { least: 120, first: 320, most: 900 };
/** In windows narrower than this the card stands upright. */
const UPRIGHT_BELOW_PX = 640;
/** From the point that one looks at to the centre of the blind spot, as in the paper. */
const BLIND_SPOT_DEG = 13.5;
const DOT_MM_PER_S = 20;
const ROUNDS = 5;
/** On a window less wide than this the blind spot may lie beside it. */
const WIDE_ENOUGH_MM = 110;

/** What is found; the screen's part of a session takes it in. */
export type Calibration = Record<string, number>;

/** Ask for what the study wants to know of the screen's size and distance. */
export async function calibrate(root: HTMLElement, wanted: ScreenRules): Promise<Calibration> {
  if (!wanted.calibrate) {
    return {};
  }
  const px_per_mm = await matchCard(root);
  const wide = document.documentElement.clientWidth / px_per_mm >= WIDE_ENOUGH_MM;
  const distance = wanted.distance && wide ? await findDistance(root, px_per_mm) : {};
  return { px_per_mm, ...distance };
}

/** Resolve with CSS pixels per millimetre when the drawn card is as wide as a real one. */
async function matchCard(root: HTMLElement): Promise<number> {
  const upright = window.innerWidth < UPRIGHT_BELOW_PX;
  const card = element("div", { class: "card", "aria-hidden": "true" });
  card.style.aspectRatio = upright ? "53.98 / 85.6" : "85.6 / 53.98";
  const slider = element("input", {
    type: "range",
    id: "card-width",
    min: String(CARD_PX.least),
    max: String(CARD_PX.most),
    step: "1",
    value: String(CARD_PX.first),
  });
  const follow = () => {
    card.style.width = `${slider.value}px`;
  };
  slider.addEventListener("input", follow);
  const go = element("button", { class: "primary", type: "button" }, message("card.continue"));
  const page = showPage(
    root,
    message("card.title"),
    element("p", {}, message(upright ? "card.upright" : "card.text")),
    element("label", { for: "card-width" }, message("card.slider")),
    slider,
    go,
    card,
  );
  page.classList.add("wide");
  slider.max = String(Math.min(CARD_PX.most, Math.floor(slider.clientWidth))); // what there is room for
  follow();
  await pressed(go);
  return Number(slider.value) / (upright ? CARD_MM.short : CARD_MM.long);
}

/** Resolve with the distance from eye to screen, the median of some rounds. */
async function findDistance(root: HTMLElement, px_per_mm: number): Promise<Calibration> {
  const field = element("div", { class: "blind-spot", "aria-hidden": "true" });
  const [look, dot] = [element("span", { class: "look" }), element("span", { class: "dot" })];
  field.append(look, dot);
  const vanished = element("button", { class: "primary", type: "button" });
  const skip = element("button", { class: "quiet", type: "button" }, message("distance.skip"));
  const page = showPage(
    root,
    message("distance.title"),
    element("p", {}, message("distance.text")),
    field,
    element("div", { class: "saves" }, vanished, skip),
  );
  page.classList.add("wide");
  vanished.focus();
  const found: number[] = [];
  for (let round = 1; round <= ROUNDS; round++) {
    vanished.textContent = message("distance.vanished", { round, rounds: ROUNDS });
    const apart_px = await moveUntilPressed(look, dot, DOT_MM_PER_S * px_per_mm, vanished, skip);
    if (apart_px === null) {
      return {};
    }
    found.push(apart_px / px_per_mm / Math.tan((BLIND_SPOT_DEG * Math.PI) / 180));
  }
  return { distance_mm: found.toSorted((a, b) => a - b)[Math.floor(ROUNDS / 2)] as number };
}

/** Move the dot away to the left, again and again; resolve with its distance at a press. */
async function moveUntilPressed(
  look: HTMLElement,
  dot: HTMLElement,
  px_per_s: number,
  vanished: HTMLButtonElement,
  skip: HTMLButtonElement,
): Promise<number | null> {
  let outcome: "vanished" | "skip" | null = null;
  void pressed(vanished).then(() => {
    outcome ??= "vanished";
  });
  void pressed(skip).then(() => {
    outcome ??= "skip";
  });
  let apart_px = 0;
  for (let [before_s, now_s] = [await nextFrame(), await nextFrame()]; outcome === null; ) {
    apart_px = (apart_px + (now_s - before_s) * px_per_s) % look.offsetLeft;
    dot.style.left = `${look.offsetLeft - apart_px}px`;
    [before_s, now_s] = [now_s, await nextFrame()];
  }
  return outcome === "vanished" ? apart_px : null;
}
