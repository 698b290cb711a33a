/** The texts of the pages, from the message file of the study's language. */

import en from "../messages/en.json";
import es from "../messages/es.json";

export type MessageKey = keyof typeof en;

const TRANSLATIONS: Record<string, Record<MessageKey, string>> = { en, es };

let texts: Partial<Record<MessageKey, string>> = en;

/**
 * Choose the language of the pages.
 *
 * @param tag - Such as `es` or `es-MX`; English where there are no texts in it.
 */
export function setLanguage(tag: string): void {
  texts = TRANSLATIONS[tag.split("-")[0] ?? ""] ?? en;
}

/**
 * Return a text with its `{placeholders}` filled in.
 *
 * @throws Error if a placeholder has no value: a text must never reach a participant half filled.
 */
export function message(key: MessageKey, values: Record<string, string | number> = {}): string {
  return (texts[key] ?? en[key]).replace(/\{(\w+)\}/g, (_, name: string) => {
    const value = values[name];
    if (value === undefined) {
      throw new Error(`message ${key}: no value for {${name}}`);
    }
    return String(value);
  });
}
