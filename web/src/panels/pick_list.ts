import { element } from "../dom";
import type { Pick, PlanFit } from "../types";

export interface PickListActions {
  rename(index: number, name: string): void;
  remove(index: number): void;
  save(): void;
}

const kHeadTitles: Record<string, string> = {
  Name: "Any name that you know the place by",
  "Off by": "How far the map has the place from where it was clicked on the plan. One far larger than the others is wrong.",
};

const centimetres = (metres: number) => `${(100 * metres).toFixed(1)} cm`;

/** The picks, how well they fit, and what to do with them. */
export class PickList {
  readonly panel: HTMLElement;
  readonly #step = element("p", { class: "step", role: "status" });
  readonly #rows = element("tbody");
  readonly #table: HTMLTableElement;
  readonly #fit = element("p", { class: "fit", title: "The smaller, the better: a few centimetres are good" });
  readonly #doubts = element("ul", { class: "doubts" });
  readonly #save = element("button", { type: "button", class: "primary", id: "save", title: "Writes a copy of the map that knows its place on the plan" }, "Save the map on the plan");
  readonly #saved = element("p", { class: "saved", role: "status" });
  readonly #actions: PickListActions;
  readonly #output: string | null;

  constructor(output: string | null, actions: PickListActions) {
    this.#actions = actions;
    this.#output = output;
    const heads = ["", "Name", "Off by", ""].map((name) => element("th", { scope: "col", title: kHeadTitles[name] ?? "" }, name));
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
    if (!output) this.#saved.textContent = "To save, start byre view with -o FILE.";
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
    const scale = fit && Math.abs(fit.registration.scale - 1) > 1e-9 ? `, ${fit.registration.scale.toFixed(3)} m a unit` : "";
    const farOff = fit?.is_far_off ? `; the map is off its plan by ${fit.residual_m.toFixed(2)} m` : "";
    this.#fit.textContent = fit ? `${took} picks fit to ${centimetres(fit.rms_m)}${scale}${farOff}` : problem;
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
    row.title = `Point ${pick.point} of the map${residual?.is_outlier ? ": does not fit the other picks, and was left out" : ""}`;
    return row;
  }
}
