import { kInlier, kOnline, type SeenImage } from "../decode";
import { element } from "../dom";
import { loadImage } from "../server";
import { colour, onThemeChange } from "../theme";

const kRadius = 2.3; // of a point, CSS pixels

/** Left image with the matched map points: offline inliers round, online inliers square, outliers crossed. */
export class CameraImage {
  readonly panel: HTMLElement;
  readonly #canvas = element("canvas", { class: "image" });
  readonly #caption = element("figcaption");
  #image: SeenImage | null = null;
  #bitmap: ImageBitmap | null = null;
  #wanted: number | null = null; // frame number of the image to load next
  #isLoading = false;

  constructor(width: number, height: number) {
    Object.assign(this.#canvas, { width, height });
    this.#canvas.setAttribute("role", "img");
    this.panel = element(
      "figure",
      { class: "panel camera" },
      this.#canvas,
      this.#caption,
      element(
        "p",
        { class: "legend" },
        element("span", { class: "key offline", title: "Point of the offline map that fits the pose" }, "● offline point"),
        element("span", { class: "key online", title: "Point mapped during this run that fits the pose" }, "■ online point"),
        element("span", { class: "key", title: "Matched point that does not fit the pose: moved object or wrong match" },
          "✕ does not fit"),
      ),
    );
    onThemeChange(() => this.#draw());
  }

  /** Shows a received image. */
  async show(image: SeenImage): Promise<void> {
    const bitmap = await createImageBitmap(image.jpeg);
    this.#bitmap?.close();
    this.#bitmap = bitmap;
    this.#image = image;
    this.#draw();
  }

  /** Loads and shows the image of a frame. Of concurrent requests the last one is shown. */
  async request(frame: number): Promise<void> {
    this.#wanted = frame;
    if (this.#isLoading) return;
    this.#isLoading = true;
    while (this.#wanted !== null) {
      const next: number = this.#wanted;
      this.#wanted = null;
      try {
        await this.show(await loadImage(next));
      } catch {
        this.#caption.textContent = "No image of this frame is stored.";
      }
    }
    this.#isLoading = false;
  }

  #draw(): void {
    const image = this.#image;
    if (!image || !this.#bitmap) return;
    const context = this.#canvas.getContext("2d") as CanvasRenderingContext2D;
    context.drawImage(this.#bitmap, 0, 0, this.#canvas.width, this.#canvas.height);
    const radius = (kRadius * this.#canvas.width) / Math.max(this.#canvas.clientWidth, 1);
    const colours = [colour("offline-on-image"), colour("online-on-image")];
    image.kinds.forEach((kind, i) => {
      context.strokeStyle = context.fillStyle = colours[kind & kOnline];
      drawMark(context, image.pixels[2 * i] + 0.5, image.pixels[2 * i + 1] + 0.5, radius, kind);
    });
    this.#describe(image);
  }

  #describe(image: SeenImage): void {
    const inliers = image.kinds.filter((kind) => kind & kInlier);
    const online = inliers.filter((kind) => kind & kOnline).length;
    const said = `Image ${image.frame}: ${inliers.length - online} offline and ${online} online points fit, ${
      image.kinds.length - inliers.length
    } do not`;
    this.#caption.textContent = said;
    this.#canvas.setAttribute("aria-label", said);
  }
}

function drawMark(context: CanvasRenderingContext2D, x: number, y: number, r: number, kind: number): void {
  context.beginPath();
  if (!(kind & kInlier)) {
    context.lineWidth = 0.5 * r;
    context.moveTo(x - r, y - r);
    context.lineTo(x + r, y + r);
    context.moveTo(x - r, y + r);
    context.lineTo(x + r, y - r);
    context.stroke();
  } else if (kind & kOnline) {
    context.fillRect(x - 0.85 * r, y - 0.85 * r, 1.7 * r, 1.7 * r);
  } else {
    context.arc(x, y, r, 0, 2 * Math.PI);
    context.fill();
  }
}
