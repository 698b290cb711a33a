/** The order into which a participant brings images; the lab follows the same (`ordering.py`). */

/** Images in places, the best in the first; unchangeable. */
export class Order {
  /**
   * @param images - The image in each place, as its number in the order shown, from 0.
   * @param tied - The places whose image is as good as the one in the place before.
   */
  constructor(
    readonly images: readonly number[],
    readonly tied: ReadonlySet<number> = new Set(),
  ) {}

  /** Return the order in which that many images are shown at first. */
  static asShown(count: number): Order {
    return new Order(Array.from({ length: count }, (_, index) => index));
  }

  /** Return the order with the image of one place put into another; those between shift. */
  moved(source: number, target: number): Order {
    const images = [...this.images];
    images.splice(target, 0, ...images.splice(source, 1));
    return new Order(images, this.tied);
  }

  /** Return the order with a place tied to the one before, or no longer; the first never is. */
  withTieChanged(place: number): Order {
    const tied = new Set(this.tied);
    if (!tied.delete(place) && place > 0 && place < this.images.length) {
      tied.add(place);
    }
    return new Order(this.images, tied);
  }

  /** Return the rank of the image in a place: 1 and the number of better images. */
  rankOfPlace(place: number): number {
    return this.tied.has(place) ? this.rankOfPlace(place - 1) : place + 1;
  }

  /** Return the rank of each image in the order shown, 1 for the best. */
  ranks(): number[] {
    return this.images.map((_, image) => this.rankOfPlace(this.images.indexOf(image)));
  }
}
