// Compares what is on the screen.

const kHeadOfStage = 60; // pixels at the top, where buttons lie over the map

/** A picture of the map, or of another element, as it is shown: a PNG file in base64. */
export async function pictureOf(page, selector) {
  const { x, y, width, height } = await page.locator(selector).boundingBox();
  const clip = { x, y: y + kHeadOfStage, width, height: height - kHeadOfStage };
  return (await page.screenshot({ clip })).toString("base64");
}

/** The same, once it does not change any more. */
export async function settledPictureOf(page, selector) {
  let before = await pictureOf(page, selector);
  for (let tries = 0; tries < 20; ++tries) {
    await page.waitForTimeout(200);
    const now = await pictureOf(page, selector);
    if (now === before) return now;
    before = now;
  }
  throw new Error(`${selector} never comes to rest`);
}

/** How many pixels of two pictures of the same size are not alike; the page itself decodes them. */
export function differentPixels(page, a, b) {
  return page.evaluate(async (pictures) => {
    const pixelsOf = async (picture) => {
      const bytes = Uint8Array.from(atob(picture), (character) => character.charCodeAt(0));
      const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
      const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
      context.drawImage(bitmap, 0, 0);
      return context.getImageData(0, 0, bitmap.width, bitmap.height).data;
    };
    const [first, second] = await Promise.all(pictures.map(pixelsOf));
    let different = 0;
    for (let i = 0; i < first.length; i += 4) {
      const distance = [0, 1, 2].reduce((sum, k) => sum + Math.abs(first[i + k] - second[i + k]), 0);
      if (distance > 24) ++different;
    }
    return different;
  }, [a, b]);
}
