import { isConfirmed } from "../confirm";
import { element } from "../dom";
import { kUnavailable, Refusal, review } from "../server";
import type { ReviewAct, ReviewTrial, VersionFields } from "../types";
import { given } from "./registry_tables";

const kMostCharacters = 1000;

interface Act {
  name: string;
  question: (site: string, version: string) => string;
}

const kActs: Record<ReviewAct, Act> = {
  accept: {
    name: "Accept",
    question: (site, version) => `Accept version ${version} for all robots of ${site}?`,
  },
  reject: {
    name: "Reject",
    question: (site, version) => `Reject version ${version} of ${site}? Its sessions are not used again.`,
  },
  rollback: {
    name: "Roll back",
    question: (site, version) => `Accept the earlier version ${version} again for all robots of ${site}?`,
  },
};

/** Reason and buttons of a review. A button that the registry would refuse is disabled, with the refusal beside it. */
export class ReviewForm {
  readonly panel: HTMLElement;
  readonly #site: string;
  readonly #reviewed: () => void;
  readonly #reason = element("input", { id: "reason", maxLength: kMostCharacters, required: true, autocomplete: "off" });
  readonly #result = element("p", { class: "result", role: "status" });
  readonly #buttons = new Map<ReviewAct, HTMLButtonElement>();
  readonly #notes = new Map<ReviewAct, HTMLElement>();
  #trials: Record<ReviewAct, ReviewTrial> | null = null;

  /** reviewed: called after each attempt. */
  constructor(site: string, reviewed: () => void) {
    this.#site = site;
    this.#reviewed = reviewed;
    const acts = (Object.keys(kActs) as ReviewAct[]).map((act) => this.#makeAct(act));
    this.panel = element(
      "section",
      { class: "listing review", ariaLabel: "Review" },
      element("h2", {}, "Review"),
      element("label", { htmlFor: "reason" }, "Reason, for the history of the site"),
      this.#reason,
      element("ul", { class: "acts" }, ...acts),
      this.#result,
    );
  }

  show({ id, reviews }: VersionFields): void {
    this.#trials = reviews;
    for (const [act, button] of this.#buttons) {
      const { version, refusal } = reviews[act];
      button.disabled = refusal !== "";
      const note = this.#notes.get(act) as HTMLElement;
      note.textContent = refusal || (version === id ? "" : `Accepts ${version} again`);
    }
  }

  #makeAct(act: ReviewAct): HTMLElement {
    const button = element("button", { type: "button" }, kActs[act].name);
    const note = element("span", { class: "none", id: `note-${act}` });
    button.setAttribute("aria-describedby", note.id);
    button.addEventListener("click", () => this.#act(act));
    this.#buttons.set(act, button);
    this.#notes.set(act, note);
    return element("li", {}, button, " ", note);
  }

  async #act(act: ReviewAct): Promise<void> {
    const reason = this.#reason.value.trim();
    const version = this.#trials?.[act].version;
    if (!version) return;
    if (!reason) {
      this.#result.textContent = "Give a reason first.";
      this.#reason.focus();
      return;
    }
    const { name, question } = kActs[act];
    if (!(await isConfirmed(question(this.#site, version), name, "Cancel"))) return;
    try {
      await review(this.#site, version, act, reason);
      this.#reason.value = "";
      this.#result.textContent = act === "reject" ? `Rejected: ${version}` : `Accepted: ${version}`;
    } catch (error) {
      const isCertain = error instanceof Refusal && error.status !== kUnavailable;
      const outcome = isCertain ? "Not done:" : "Outcome unknown, see the history:";
      this.#result.replaceChildren(element("strong", {}, outcome), " ", given((error as Error).message));
    }
    this.#reviewed();
  }
}
