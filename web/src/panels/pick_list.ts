import { element } from "../dom";
import type { Pick, PlanFit } from "../types";

export interface PickListActions {
  rename(index: number, name: string): void;
  remove(index: number): void;
  save(): void;
}

const kHeadTitles: Record<string, string> = {
  Name: "Name of the place, stored in the file of picks",
  Error: "Distance between the place on the plan and the registered map point. A much larger error indicates a wrong pick.",
};

const centimetres = (metres: number) => `${(100 * metres).toFixed(1)} cm`;

/** Picks with their residuals, and the button that saves the registered map. */
export class PickList {
  readonly panel: HTMLElement;
  readonly #step = element("p", { class: "step", role: "status" });
  readonly #rows = element("tbody");
  readonly #table: HTMLTableElement;
  readonly #fit = element("p", { class: "fit", title: "Root mean square error without outliers. A few centimetres are good." });
  readonly #doubts = element("ul", { class: "doubts" });
  readonly #save = element(
    "button",
    { type: "button", class: "primary", id: "save", title: "Writes a copy of the map with its registration on the plan" },
    "Save the registered map",
  );
  readonly #saved = element("p", { class: "saved", role: "status" });
  readonly #actions: PickListActions;
  readonly #output: string | null;

  constructor(output: string | null, actions: PickListActions) {
    this.#actions = actions;
    this.#output = output;
    const heads = ["", "Name", "Error", ""].map((name) => element("th", { scope: "col", title: kHeadTitles[name] ?? "" }, name));
    this.#table = element("table", { class: "picks" }, element("thead", {}, element("tr", {}, ...heads)), this.#rows);
    this.#save.addEventListener("click", () => actions.save());
    this.panel = element(
      "section",
      { class: "panel picking", ariaLabel: "Picks" },
      this.#step,
      this.#table,
      this.#fit,
      this.#doubts,
      this.#save,
      this.#saved,
    );
    if (!output) this.#saved.textContent = "Saving needs the option -o FILE of byre view.";
  }

  tellStep(text: string): void {
    this.#step.textContent = text;
  }

  tellSaved(text: string): void {
    this.#saved.textContent = text;
  }

  show(picks: Pick[], fit: PlanFit | null, problem: string): void {
    this.#rows.replaceChildren(...picks.map((pick, i) => this.#row(pick, i, fit)));
    this.#table.hidden = picks.length === 0;
    const took = fit?.residuals.filter(({ is_outlier }) => !is_outlier).length;
    const scale = fit && Math.abs(fit.registration.scale - 1) > 1e-9 ? `, scale ${fit.registration.scale.toFixed(3)} m per unit` : "";
    const farOff = fit?.is_far_off ? `; residual of the map ${fit.residual_m.toFixed(2)} m` : "";
    this.#fit.textContent = fit ? `${took} picks fit, rms ${centimetres(fit.rms_m)}${scale}${farOff}` : problem;
    this.#doubts.replaceChildren(...(fit?.doubts ?? []).map((doubt) => element("li", {}, doubt)));
    this.#save.disabled = !fit || !this.#output;
  }

  #row(pick: Pick, index: number, fit: PlanFit | null): HTMLElement {
    const residual = fit?.residuals[index];
    const name = element("input", { value: pick.name, ariaLabel: `Name of pick ${index + 1}` });
    name.addEventListener("change", () => this.#actions.rename(index, name.value));
    const remove = element("button", { type: "button", class: "quiet", ariaLabel: `Remove ${pick.name}` }, "Remove");
    remove.addEventListener("click", () => this.#actions.remove(index));
    const off = residual ? centimetres(Math.hypot(...residual.error_m)) : "–";
    const row = element(
      "tr",
      { class: residual?.is_outlier ? "outlier" : "" },
      element("th", { scope: "row" }, String(index + 1)),
      element("td", {}, name),
      element("td", { class: "number" }, residual?.is_outlier ? `✕ ${off}` : off),
      element("td", {}, remove),
    );
    row.title = `Map point ${pick.point}${residual?.is_outlier ? ": outlier, excluded from the fit" : ""}`;
    return row;
  }
}
