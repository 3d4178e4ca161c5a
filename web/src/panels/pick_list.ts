import { element } from "../dom";
import type { NextPick, Pick, PlanFit, Proposal } from "../types";

export type Tool = "corner" | "wall" | "station";

export interface PickListActions {
  use(tool: Tool): void;
  undo(): void;
  rename(index: number, name: string): void;
  remove(index: number): void;
  showNext(next: NextPick): void;
  propose(): void;
  save(): void;
}

const kHeadTitles: Record<string, string> = {
  Name: "Name of the place, stored in the file of picks",
  Error: "Distance between the place on the plan and the registered map point. A much larger error indicates a wrong pick.",
};

const kTools: Record<Tool, [string, string]> = {
  corner: ["Corner", "Click the same corner in two pictures or more, then on the plan"],
  wall: ["Wall", "Click two points along the foot of a wall in a picture, then two along the wall on the plan"],
  station: ["Robot", "Click on the plan where the robot stood when the picture was taken, such as by a tape measure"],
};

const centimetres = (metres: number) => `${(100 * metres).toFixed(1)} cm`;

/** Picks with their residuals, the next best pick, and the buttons that propose and save a registration. */
export class PickList {
  readonly panel: HTMLElement;
  readonly #tools: Record<Tool, HTMLElement>;
  readonly #step = element("p", { class: "step", role: "status" });
  readonly #rows = element("tbody");
  readonly #table: HTMLTableElement;
  readonly #fit = element("p", { class: "fit", title: "Root mean square error without outliers. A few centimetres are good." });
  readonly #doubts = element("ul", { class: "doubts" });
  readonly #next = element("p", { class: "next" });
  readonly #save = element(
    "button",
    { type: "button", class: "primary", id: "save", title: "Writes a copy of the map with its registration on the plan" },
    "Save the registered map",
  );
  readonly #saved = element("p", { class: "saved", role: "status" });
  readonly #actions: PickListActions;
  readonly #output: string | null;

  /** hasPictures: whether places can be picked in pictures. */
  constructor(output: string | null, hasPictures: boolean, actions: PickListActions) {
    this.#actions = actions;
    this.#output = output;
    const heads = ["", "Name", "Error", ""].map((name) => element("th", { scope: "col", title: kHeadTitles[name] ?? "" }, name));
    this.#table = element("table", { class: "picks" }, element("thead", {}, element("tr", {}, ...heads)), this.#rows);
    const button = (name: string, title: string, act: () => void) => {
      const made = element("button", { type: "button", title }, name);
      made.addEventListener("click", act);
      return made;
    };
    const tool = (each: Tool) => button(...kTools[each], () => actions.use(each));
    this.#tools = { corner: tool("corner"), wall: tool("wall"), station: tool("station") };
    this.#save.addEventListener("click", () => actions.save());
    this.panel = element(
      "section",
      { class: "panel picking", ariaLabel: "Picks" },
      this.#step,
      element(
        "p",
        { class: "buttons" },
        ...(hasPictures ? Object.values(this.#tools) : []),
        button("Undo click", "Removes the last click of the present pick", () => actions.undo()),
      ),
      this.#table,
      this.#fit,
      this.#doubts,
      this.#next,
      element(
        "p",
        { class: "buttons" },
        button("Propose by walls", "Matches the walls of the map with the plan. Check the result before saving", () => actions.propose()),
        this.#save,
      ),
      this.#saved,
    );
    if (!output) this.#saved.textContent = "Saving needs the option -o FILE of byre view.";
  }

  showTool(tool: Tool): void {
    for (const [name, button] of Object.entries(this.#tools)) button.setAttribute("aria-pressed", String(name === tool));
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
    this.#showDoubts([...wrongPicks(picks, fit), ...(fit?.doubts ?? [])]);
    this.#showNext(fit?.next ?? null);
    this.#save.disabled = !fit || !this.#output;
  }

  showProposal(proposal: Proposal): void {
    this.#fit.textContent = `Proposal: ${proposal.description}`;
    this.#showDoubts(proposal.doubt ? [`Ambiguous: ${proposal.doubt}`] : []);
    this.#showNext(null);
    this.#save.disabled = !this.#output;
  }

  #showDoubts(doubts: string[]): void {
    this.#doubts.replaceChildren(...doubts.map((doubt) => element("li", {}, doubt)));
  }

  #showNext(next: NextPick | null): void {
    this.#next.replaceChildren();
    if (!next) return;
    const show = element("button", { type: "button", class: "quiet" }, "Show its picture");
    show.addEventListener("click", () => this.#actions.showNext(next));
    const effect = `${centimetres(next.sigma_before_m)} to ${centimetres(next.sigma_after_m)}`;
    this.#next.append(`Next best pick: near the ring. Uncertainty on the path: ${effect}`, " ", show);
  }

  #row(pick: Pick, index: number, fit: PlanFit | null): HTMLElement {
    const residual = fit?.residuals[index];
    const name = element("input", { value: pick.name, ariaLabel: `Name of pick ${index + 1}` });
    name.addEventListener("change", () => this.#actions.rename(index, name.value));
    const remove = element("button", { type: "button", class: "quiet", ariaLabel: `Remove ${pick.name}` }, "Remove");
    remove.addEventListener("click", () => this.#actions.remove(index));
    const off = residual ? centimetres(Math.hypot(...residual.error_m)) : "–";
    return element(
      "tr",
      { class: residual?.is_outlier ? "outlier" : "" },
      element("th", { scope: "row" }, String(index + 1)),
      element("td", {}, name),
      element("td", { class: "number" }, residual?.is_outlier ? `✕ ${off}` : off),
      element("td", {}, remove),
    );
  }
}

function wrongPicks(picks: Pick[], fit: PlanFit | null): string[] {
  return picks.flatMap(({ name }, i) => {
    const residual = fit?.residuals[i];
    if (!residual?.is_outlier) return [];
    return [`${name} is wrong: it is off by ${centimetres(Math.hypot(...residual.error_m))}. Correct or remove it.`];
  });
}
