/** Loading and decoding every image before the first trial, so that none is waited for later. */

import { getBlob, getJson, type Picture, type RegionRuns } from "./api";
import { Regions } from "./regions";
import { retry } from "./retry";
import type { Stimulus } from "./stimulus";

/** How many requests are under way at once. */
export const PARALLEL = 6;

/** How the preloader gets at bytes; replaced in tests. */
export interface Loader {
  image(path: string): Promise<HTMLImageElement>;
  regions(path: string): Promise<Regions>;
}

/** Load through the server's interface with a session's token, or without one. */
export function apiLoader(token: string | null): Loader {
  return {
    async image(path) {
      const image = new Image();
      image.src = URL.createObjectURL(await getBlob(path, token));
      await image.decode();
      return image;
    },
    async regions(path) {
      return Regions.fromRuns(await getJson<RegionRuns>(path, token));
    },
  };
}

/**
 * Load the stimuli of trials, each file once however many trials share it.
 *
 * @param onProgress - Called with the number of loaded files and of all.
 * @param onFailure - Called when a file could not be had, before it is tried again.
 * @returns The stimuli by trial index.
 * @throws ApiError if the server refuses a file; passing failures are retried.
 */
export async function preload(
  trials: { index: number; pictures: Picture[] }[],
  loader: Loader,
  onProgress: (loaded: number, total: number) => void = () => {},
  onFailure: () => void = () => {},
): Promise<Map<number, Stimulus[]>> {
  const images = new Map<string, HTMLImageElement>();
  const regions = new Map<string, Regions>();
  const pictures = trials.flatMap((trial) => trial.pictures);
  const maps = pictures.map((picture) => picture.regions).filter((path) => path !== null);
  const tasks = [
    ...unique(maps).map((path) => async () => {
      regions.set(path, await retry(() => loader.regions(path), onFailure));
    }),
    ...unique(pictures.map((picture) => picture.image)).map((path) => async () => {
      images.set(path, await retry(() => loader.image(path), onFailure));
    }),
  ];
  await inParallel(tasks, onProgress);
  const stimulus = ({ image, regions: map, width_px, height_px }: Picture): Stimulus => ({
    image: images.get(image) as HTMLImageElement,
    width_px,
    height_px,
    regions: map === null ? null : (regions.get(map) as Regions),
  });
  return new Map(trials.map(({ index, pictures }) => [index, pictures.map(stimulus)]));
}

/** Load pictures as `preload` does; returns their stimuli by the images' addresses. */
export async function preloadPictures(
  pictures: Picture[],
  loader: Loader,
  onProgress?: (loaded: number, total: number) => void,
  onFailure?: () => void,
): Promise<Map<string, Stimulus>> {
  const all = [{ index: 0, pictures }];
  const loaded = (await preload(all, loader, onProgress, onFailure)).get(0) ?? [];
  return new Map(loaded.map((stimulus, place) => [pictures[place]?.image ?? "", stimulus]));
}

async function inParallel(
  tasks: (() => Promise<void>)[],
  onProgress: (done: number, total: number) => void,
): Promise<void> {
  const total = tasks.length;
  const waiting = [...tasks];
  let done = 0;
  onProgress(done, total);
  const work = async () => {
    for (let task = waiting.shift(); task !== undefined; task = waiting.shift()) {
      await task();
      onProgress(++done, total);
    }
  };
  await Promise.all(Array.from({ length: Math.min(PARALLEL, total) }, work));
}

function unique(paths: string[]): string[] {
  return [...new Set(paths)];
}
