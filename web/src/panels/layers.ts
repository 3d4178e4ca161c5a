import { element } from "../dom";

/** Layer or mode that can be switched on and off. */
export interface Layer {
  name: string;
  /** Sign before the name; colour: class of its colour. */
  mark?: string;
  colour?: string;
  key?: string;
  /** Tooltip. */
  title?: string;
  isOn: boolean;
  set: (isOn: boolean) => void;
}

/** Toggle button of a layer; pressed while the layer is on. */
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

/** Button of an action; what: tooltip. */
export function actionButton(name: string, key: string, what: string, act: () => void): HTMLButtonElement {
  const button = element("button", { type: "button", class: "layer", title: `${what}. Key ${key}` }, name);
  button.addEventListener("click", act);
  return button;
}
