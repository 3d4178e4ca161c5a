import { byId, element } from "./dom";
import {
  eventsTable,
  given,
  jobsTable,
  linkTo,
  plansTable,
  robotsTable,
  routeTo,
  sessionsTable,
  sitesTable,
  stateOf,
  timeOf,
  versionsTable,
} from "./panels/registry_tables";
import { ReviewForm } from "./panels/review_form";
import {
  kRetryMilliseconds,
  kUnavailable,
  listen,
  loadEvents,
  loadSite,
  loadSites,
  loadVersion,
  Refusal,
} from "./server";
import type { RegistryScene, VersionFields } from "./types";

/** Page of a registry: its sites, a site or a version, by the fragment of the address. */
export function startRegistryPage(scene: RegistryScene): void {
  byId("subtitle").replaceChildren("Account ", given(scene.account));
  byId("main").classList.add("registry");
  new RegistryPage();
}

/** Link from the page of a map, /maps/SITE/VERSION/, to the review of the version. */
export function linkToReview(): HTMLElement {
  const [site, version] = location.pathname.split("/").slice(2).map(decodeURIComponent);
  return element("a", { href: `/${location.search}${routeTo(site, version)}` }, "Back to the review");
}

interface View {
  heading: string;
  /** Decides whether the view has changed. */
  content: unknown;
  panels: HTMLElement[];
  version?: VersionFields;
}

class RegistryPage {
  readonly #path = element("nav", { ariaLabel: "Position" });
  readonly #heading = element("h2", { class: "heading", tabIndex: -1 });
  readonly #problem = element("p", { class: "problem", role: "status" });
  readonly #body = element("div");
  #route = "";
  #form: ReviewForm | null = null;
  #shown = ""; // content of the panels
  #loads = 0;

  constructor() {
    const page = element("section", { class: "sheet", ariaLabel: "Registry of maps" });
    page.append(this.#path, this.#heading, this.#problem, this.#body);
    byId("main").append(page);
    window.addEventListener("hashchange", () => this.#load());
    listen({
      opened: () => {
        byId("connection").replaceChildren();
        this.#load();
      },
      received: () => this.#load(),
      sawImage: () => {},
      lost: () => this.#report("No connection to byre; reconnecting"),
    });
  }

  #report(text: string): void {
    byId("connection").replaceChildren(element("span", { class: "lost" }, text));
  }

  async #load(): Promise<void> {
    const load = ++this.#loads;
    const route = location.hash;
    const { site, version } = Object.fromEntries(new URLSearchParams(route.slice(1)));
    try {
      const view = await this.#view(site, version);
      if (load !== this.#loads) return;
      byId("connection").replaceChildren();
      this.#problem.textContent = "";
      this.#show(route, view, site);
    } catch (error) {
      if (load !== this.#loads) return;
      const isRefused = error instanceof Refusal;
      if (isRefused) this.#problem.replaceChildren(given(error.message));
      if (!isRefused || error.status === kUnavailable) {
        if (isRefused) this.#report("No connection to the registry; reconnecting");
        setTimeout(() => load === this.#loads && this.#load(), kRetryMilliseconds);
      } else if (route !== this.#route) {
        this.#show(route, { heading: version ?? site, content: error.message, panels: [] }, site);
      }
    }
  }

  async #view(site?: string, version?: string): Promise<View> {
    if (!site) {
      const sites = await loadSites();
      return { heading: "Sites", content: sites, panels: [sitesTable(sites)] };
    }
    if (!version) {
      const [content, events] = await Promise.all([loadSite(site), loadEvents(site)]);
      const panels = [
        versionsTable(site, content.versions),
        plansTable(content.plans),
        sessionsTable(site, "Open sessions", content.sessions),
        jobsTable(content.jobs),
        robotsTable(site, content.robots),
        eventsTable(events),
      ];
      return { heading: site, content: [content, events], panels };
    }
    const content = await loadVersion(site, version);
    const panels = [
      versionPanel(site, content),
      sessionsTable(site, "Sessions", content.sessions),
      eventsTable(content.events),
    ];
    return { heading: version, content, panels, version: content };
  }

  #show(route: string, { heading, content, panels, version }: View, site?: string): void {
    const hasMoved = route !== this.#route || this.#shown === "";
    if (hasMoved) {
      this.#form = version && site ? new ReviewForm(site, () => this.#load()) : null;
      const parts: (Node | string)[] = [element("a", { href: "#" }, "All sites")];
      if (site) parts.push(" › ", linkTo(site));
      this.#path.replaceChildren(...parts);
      this.#path.hidden = !site;
      this.#heading.replaceChildren(site ? given(heading) : heading);
      document.title = `${heading} – byre`;
    }
    if (version) this.#form?.show(version);
    const text = JSON.stringify(content);
    if (hasMoved || text !== this.#shown) this.#replace(panels);
    if (route !== this.#route) this.#heading.focus();
    this.#shown = text;
    this.#route = route;
  }

  /** Keeps the form with its reason, and the focus on a link. */
  #replace([first, ...rest]: HTMLElement[]): void {
    const focused = document.activeElement;
    const link = this.#body.contains(focused) ? focused?.getAttribute("href") : null;
    const form = this.#form?.panel;
    for (const child of [...this.#body.children]) if (child !== form) child.remove();
    if (form && !form.isConnected) this.#body.append(form);
    if (first) this.#body.prepend(first);
    this.#body.append(...rest);
    if (link) this.#body.querySelector<HTMLElement>(`a[href="${CSS.escape(link)}"]`)?.focus();
  }
}

function versionPanel(site: string, version: VersionFields): HTMLElement {
  const list = element("dl");
  const add = (name: string, ...content: (Node | string)[]) =>
    list.append(element("dt", {}, name), element("dd", {}, ...content));
  add("State", stateOf(version.state));
  if (version.note) add("Note", given(version.note));
  if (version.parents.length) add("Made of", ...version.parents.flatMap((parent) => [linkTo(site, parent), " "]));
  add("Proposed by", given(version.added_by), " ", timeOf(version.added_at));
  if (version.reviewed_by) add("Review", given(`${version.reviewed_by}: ${version.reason ?? ""}`));
  add("Size", given(`${(version.bytes / 1e6).toFixed(1)} MB`));
  const map = `maps/${encodeURIComponent(site)}/${version.id}/${location.search}`;
  const name = version.parents.length ? "Show the map and its changes" : "Show the map";
  const link = element("a", { href: map }, name);
  return element("section", { class: "listing", ariaLabel: "Version" }, list, element("p", {}, link));
}
