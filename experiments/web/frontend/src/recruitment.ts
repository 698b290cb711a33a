/** What of the address a recruitment service put there for the study. */

import type { Study } from "./api";

/** Return the parameters of the address that the study declares. */
export function recruitmentOf({ recruitment }: Study): Record<string, string> {
  const given = new URLSearchParams(location.search);
  const found = recruitment.parameters.map((name) => [name, given.get(name) ?? ""]);
  return Object.fromEntries(found.filter(([, value]) => value !== ""));
}

/** Tell whether the address says who comes: the first parameter does. */
export function tellsWho({ recruitment }: Study, given: Record<string, string>): boolean {
  return recruitment.parameters[0] !== undefined && recruitment.parameters[0] in given;
}
