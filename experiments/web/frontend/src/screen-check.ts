/** Whether the screen is what a study asks for, in the participant's words. */

import type { Gamut, ScreenRules } from "./api";
import { colorGamut, zoom } from "./device";
import { message } from "./messages";

const GAMUTS: Gamut[] = ["srgb", "p3", "rec2020"];
/** Browsers round the sizes from which the zoom is known. */
const ZOOMED = 0.05;

/** Return what keeps the participant from beginning: one sentence for each fault, or none. */
export function screenFaults(wanted: ScreenRules): string[] {
  if (wanted.rule === "flag") {
    return []; // the server notes what is wrong
  }
  return [windowFault(wanted), gamutFault(wanted), zoomFault(wanted)].filter((text) => text !== "");
}

function windowFault({ minimum_width_px, minimum_height_px }: ScreenRules): string {
  if (window.innerWidth >= minimum_width_px && window.innerHeight >= minimum_height_px) {
    return "";
  }
  return message("consent.window", {
    width: minimum_width_px,
    height: minimum_height_px,
    actual_width: window.innerWidth,
    actual_height: window.innerHeight,
  });
}

function gamutFault({ color_gamut }: ScreenRules): string {
  const gamut = colorGamut();
  if (color_gamut === null || gamut === null) {
    return "";
  }
  const enough = GAMUTS.indexOf(gamut) >= GAMUTS.indexOf(color_gamut);
  return enough ? "" : message("consent.gamut", { gamut: color_gamut });
}

function zoomFault({ allow_zoom }: ScreenRules): string {
  if (allow_zoom || Math.abs(zoom() - 1) <= ZOOMED) {
    return "";
  }
  return message("consent.zoom", { zoom: Math.round(100 * zoom()) });
}
