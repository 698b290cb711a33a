/** What the browser tells of itself and of the screen. */

import type { Gamut } from "./api";

const BROWSERS: [name: string, pattern: RegExp][] = [
  ["Edge", /Edg(?:e|A|iOS)?\/([\d.]+)/],
  ["Opera", /OPR\/([\d.]+)/],
  ["Samsung Internet", /SamsungBrowser\/([\d.]+)/],
  ["Firefox", /(?:Firefox|FxiOS)\/([\d.]+)/],
  ["Chrome", /(?:Chrome|CriOS)\/([\d.]+)/],
  ["Safari", /Version\/([\d.]+).*Safari/],
];

const SYSTEMS: [name: string, pattern: RegExp][] = [
  ["Windows", /Windows/],
  ["Android", /Android/],
  ["iOS", /iPhone|iPad|iPod/],
  ["macOS", /Mac OS X/],
  ["ChromeOS", /CrOS/],
  ["Linux", /Linux/],
];

/**
 * Return browser, its main version and system, from a user agent string.
 *
 * @example describeDevice(navigator.userAgent) // "Firefox 140, Linux"
 */
export function describeDevice(userAgent: string): string {
  const system = SYSTEMS.find(([, pattern]) => pattern.test(userAgent))?.[0] ?? "unknown system";
  for (const [name, pattern] of BROWSERS) {
    const version = pattern.exec(userAgent)?.[1];
    if (version !== undefined) {
      return `${name} ${version.split(".")[0]}, ${system}`;
    }
  }
  return `unknown browser, ${system}`;
}

/** Return sizes of screen and window in CSS pixels, device pixels per CSS pixel, and colours. */
export function describeScreen(): Record<string, number | string> {
  const color_gamut = colorGamut();
  return {
    width_px: screen.width,
    height_px: screen.height,
    color_depth_bits: screen.colorDepth,
    ...(color_gamut === null ? {} : { color_gamut }),
    ...describeWindow(),
  };
}

/** Return what of the screen may change within a session. */
export function describeWindow(): Record<string, number> {
  return {
    window_width_px: window.innerWidth,
    window_height_px: window.innerHeight,
    pixel_ratio: window.devicePixelRatio,
    zoom: Math.round(100 * zoom()) / 100,
  };
}

/** Return the widest gamut that the screen shows, or null where the browser does not tell. */
export function colorGamut(): Gamut | null {
  const gamuts: Gamut[] = ["rec2020", "p3", "srgb"];
  return gamuts.find((gamut) => window.matchMedia(`(color-gamut: ${gamut})`).matches) ?? null;
}

/**
 * Return the page's zoom, 1 for none, as far as it can be known.
 *
 * Browsers tell no zoom. At a desk the window's outer width does not follow it and the inner one
 * does, but side bars count as zoom; where one pinches, the zoom is that of the visible part.
 */
export function zoom(): number {
  if (window.matchMedia("(pointer: coarse)").matches) {
    return window.visualViewport?.scale ?? 1;
  }
  return window.outerWidth > 0 ? window.outerWidth / window.innerWidth : 1;
}
