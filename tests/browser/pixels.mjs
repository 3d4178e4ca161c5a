// Screenshots and their comparison.

const kHeadOfStage = 60; // height of the buttons over the map, pixels

/** Screenshot of an element without the buttons at its top: PNG in base64. */
export async function pictureOf(page, selector) {
  const { x, y, width, height } = await page.locator(selector).boundingBox();
  const clip = { x, y: y + kHeadOfStage, width, height: height - kHeadOfStage };
  return (await page.screenshot({ clip })).toString("base64");
}

/** Screenshot as by pictureOf, after it has stopped changing. Throws after 20 attempts. */
export async function settledPictureOf(page, selector) {
  let before = await pictureOf(page, selector);
  for (let tries = 0; tries < 20; ++tries) {
    await page.waitForTimeout(200);
    const now = await pictureOf(page, selector);
    if (now === before) return now;
    before = now;
  }
  throw new Error(`${selector} keeps changing`);
}

/** Number of pixels that differ between two screenshots of the same size; decoded by the page. */
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
