import { beforeEach, describe, expect, it } from "vitest";
import en from "../messages/en.json";
import es from "../messages/es.json";
import { describeDevice } from "../src/device";
import { message, setLanguage } from "../src/messages";
import { askDemographics } from "../src/pages/demographics";
import { progressView } from "../src/pages/progress";

let root: HTMLElement;

beforeEach(() => {
  root = document.createElement("div");
  document.body.replaceChildren(root);
  window.scrollTo = () => {};
});

function submit() {
  root.querySelector("form")?.dispatchEvent(new SubmitEvent("submit", { cancelable: true }));
}

function faults(): string[] {
  return [...root.querySelectorAll(".fault")].map((fault) => fault.textContent ?? "");
}

describe("demographics", () => {
  it("asks only what the study lists", () => {
    void askDemographics(root, ["gender"]);
    expect([...root.querySelectorAll("input")].map((input) => input.name)).toEqual(
      Array(4).fill("gender"),
    );
  });

  it("returns valid answers with the types of the interface", async () => {
    const answers = askDemographics(root, ["age", "gender", "artistic_background"]);
    const age = root.querySelector<HTMLInputElement>("#age");
    const choose = (value: string) =>
      root.querySelector<HTMLInputElement>(`[value=${value}]`)?.click();
    if (age !== null) {
      age.value = " 34 ";
    }
    choose("undisclosed");
    choose("no");
    submit();
    expect(await answers).toEqual({ age: 34, gender: "undisclosed", artistic_background: false });
  });

  it.each(["", "0", "121", "3.5", "-4", "1e1", "old"])("refuses the age %o", (text) => {
    void askDemographics(root, ["age"]);
    const age = root.querySelector<HTMLInputElement>("#age") as HTMLInputElement;
    age.value = text;
    submit();
    expect(faults()).toEqual([message("demographics.age.fault", { youngest: 1, oldest: 120 })]);
    expect(document.activeElement).toBe(age);
    age.dispatchEvent(new Event("input", { bubbles: true }));
    expect(faults()).toEqual([""]);
  });
});

describe("messages", () => {
  it("are all there in Spanish, with the same places to fill", () => {
    const places = (text: string) => (text.match(/\{\w+\}/g) ?? []).sort();
    for (const [key, text] of Object.entries(en)) {
      expect(places(es[key as keyof typeof es] ?? ""), key).toEqual(places(text));
    }
    expect(Object.keys(es).filter((key) => !(key in en))).toEqual([]);
  });

  it.each([
    ["es", "Continuar"],
    ["es-MX", "Continuar"],
    ["xx", "Continue"],
    ["en", "Continue"],
  ])("are those of the language %s", (tag, text) => {
    setLanguage(tag);
    expect(message("demographics.continue")).toBe(text);
  });

  it("refuse to be half filled", () => {
    expect(() => message("trial.main", { number: 1 })).toThrow("total");
  });

  it("are all used by the pages, and no others", () => {
    const sources = import.meta.glob<string>("../src/**/*.ts", {
      query: "?raw",
      import: "default",
      eager: true,
    });
    const text = Object.values(sources).join("\n");
    // Some keys are put together, as `demographics.${field}.fault`: any field's name fits there.
    const patterns = [...text.matchAll(/(["`])(\w+(?:\.(?:\w+|\$\{\w+\}))+)\1/g)].map(
      ([, , key]) => new RegExp(`^${key?.replace(/\$\{\w+\}/g, "\\w+")}$`),
    );
    const unused = Object.keys(en).filter((key) => !patterns.some((used) => used.test(key)));
    expect(unused).toEqual([]);
  });
});

describe("the researcher's counts", () => {
  it("mark what a program answered, and keep it out of the people's counts", () => {
    const session = {
      session: "s.P0001.1",
      started_at: "2024-05-01T10:00:00Z",
      answers: 3,
      of: 63,
      late_share: 0.25,
      completed_at: null,
      withdrawn_at: null,
      exclusion: null,
    };
    const excluded: string[] = [];
    const progress = {
      study: "s",
      title: "T",
      target: 24,
      paused_since: null,
      abandoned_after_s: 3600,
      started: 1,
      completed: 0,
      dropped_out: 1,
      excluded: 1,
      withdrawn: 1,
      simulated_started: 1,
      simulated_completed: 0,
      pilot_started: 0,
      answers: 6,
      answers_by_hour: [
        ["2024-05-01T10:00:00+00:00", 2],
        ["2024-05-01T12:00:00+00:00", 4],
      ] as [string, number][],
      last_answer_at: null,
      sessions: [
        { ...session, participant: "P0001", simulated: false, pilot: false },
        { ...session, participant: "P0002", simulated: true, pilot: false },
        { ...session, participant: "P0003", exclusion: "why", simulated: false, pilot: false },
        { ...session, participant: "P0004", withdrawn_at: "x", simulated: false, pilot: false },
      ],
    };
    const actions = {
      exclude: (each: { participant: string }) => excluded.push(each.participant),
      withdraw: () => undefined,
    };
    root.append(...progressView(progress, actions));
    const rows = [...root.querySelectorAll("tbody tr")].map((row) => row.textContent ?? "");
    expect(rows[2]).toMatch(/P0002SIMULATED/);
    expect(rows[3]).not.toMatch(/SIMULATED/);
    expect(rows[0]).toMatch(/25.?%withdrew$/);
    expect(rows[1]).toMatch(/excluded Withdraw$/);
    root.querySelector<HTMLElement>("[aria-label='Exclude P0001']")?.click();
    expect(excluded).toEqual(["P0001"]);
    const heights = [...root.querySelectorAll("rect")].map((bar) => bar.getAttribute("height"));
    expect(heights).toEqual(["10", "20"]);
    expect(root.querySelector<HTMLElement>(".simulated-note")?.hidden).toBe(false);
  });
});

// Real user agent strings.
describe("the device", () => {
  it.each([
    [
      "Mozilla/5.0 (Windows NT 10.0; Win64; x64) AppleWebKit/537.36 (KHTML, like Gecko) Chrome/126.0.0.0 Safari/537.36 Edg/126.0.0.0",
      "Edge 126, Windows",
    ],
    [
      "Mozilla/5.0 (iPhone; CPU iPhone OS 17_5 like Mac OS X) AppleWebKit/605.1.15 (KHTML, like Gecko) Version/17.5 Mobile/15E148 Safari/604.1",
      "Safari 17, iOS",
    ],
    [
      "Mozilla/5.0 (X11; Linux x86_64; rv:127.0) Gecko/20100101 Firefox/127.0",
      "Firefox 127, Linux",
    ],
    [
      "Mozilla/5.0 (Linux; Android 14) AppleWebKit/537.36 (KHTML, like Gecko) Chrome/126.0.0.0 Mobile Safari/537.36",
      "Chrome 126, Android",
    ],
    ["curl/8.5.0", "unknown browser, unknown system"],
  ])("is read from %s", (userAgent, device) => {
    expect(describeDevice(userAgent)).toBe(device);
  });
});
