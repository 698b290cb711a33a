/** The texts of the pages, from the message file of the study's language. */

import en from "../messages/en.json";

export type MessageKey = keyof typeof en;

/**
 * Return a text with its `{placeholders}` filled in.
 *
 * @throws Error if a placeholder has no value: a text must never reach a participant half filled.
 */
export function message(key: MessageKey, values: Record<string, string | number> = {}): string {
  return en[key].replace(/\{(\w+)\}/g, (_, name: string) => {
    const value = values[name];
    if (value === undefined) {
      throw new Error(`message ${key}: no value for {${name}}`);
    }
    return String(value);
  });
}
