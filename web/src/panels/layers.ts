import { element } from "../dom";

/** Something that can be shown or not, or done or not. */
export interface Layer {
  name: string;
  /** Mark before the name, with the class of its colour. */
  mark?: string;
  colour?: string;
  key?: string;
  /** What it is, for whoever points at it. */
  title?: string;
  isOn: boolean;
  set: (isOn: boolean) => void;
}

/** A button for it, that stays pressed while it is on. */
export function layerButton(layer: Layer): HTMLButtonElement {
  const content: (Node | string)[] = [layer.name];
  if (layer.mark) content.unshift(element("span", { class: `mark ${layer.colour ?? ""}`, ariaHidden: "true" }, layer.mark));
  const button = element("button", { type: "button", class: "layer" }, ...content);
  button.title = [layer.title, layer.key ? `Key ${layer.key}` : ""].filter(Boolean).join(". ");
  const show = () => button.setAttribute("aria-pressed", String(layer.isOn));
  button.addEventListener("click", () => {
    layer.isOn = !layer.isOn;
    layer.set(layer.isOn);
    show();
  });
  show();
  return button;
}

/** A button that does something once. */
export function actionButton(name: string, key: string, what: string, act: () => void): HTMLButtonElement {
  const button = element("button", { type: "button", class: "layer", title: `${what}. Key ${key}` }, name);
  button.addEventListener("click", act);
  return button;
}
