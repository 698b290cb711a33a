/** What the browser tells of itself and of the screen. */

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

/** Return sizes of screen and window in CSS pixels, and the device pixels per CSS pixel. */
export function describeScreen(): Record<string, number> {
  return {
    width_px: screen.width,
    height_px: screen.height,
    color_depth_bits: screen.colorDepth,
    ...describeWindow(),
  };
}

/** Return what of the screen may change within a session. */
export function describeWindow(): Record<string, number> {
  return {
    window_width_px: window.innerWidth,
    window_height_px: window.innerHeight,
    pixel_ratio: window.devicePixelRatio,
  };
}
