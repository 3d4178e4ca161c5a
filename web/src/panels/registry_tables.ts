import { element } from "../dom";
import type { EventFields, SessionFields, SiteFields, SiteSummary, VersionState } from "../types";

const kMostRows = 200;

type Cell = Node | string;

/** Distinct signs, for colour-blind users, and classes of colours. */
const kStates: Record<VersionState, [string, string]> = {
  proposed: ["◆", "degraded"],
  accepted: ["●", "trusted"],
  retired: ["○", "retired"],
};

/** Text of people and robots, which is not translated. */
export function given(text: string): HTMLElement {
  return element("span", { translate: false }, text);
}

export function timeOf(stamp: string): HTMLElement {
  return element("time", { dateTime: stamp, translate: false }, stamp.replace("T", " ").replace("Z", " UTC"));
}

export function stateOf(state: VersionState): HTMLElement {
  const [sign, colour] = kStates[state];
  const mark = element("span", { class: `mark ${colour}`, ariaHidden: "true" }, sign);
  return element("span", {}, mark, element("span", {}, state));
}

/** Fragment of the address of a site, or of a version of it. */
export function routeTo(site: string, version?: string): string {
  return `#${new URLSearchParams(version ? { site, version } : { site })}`;
}

export function linkTo(site: string, version?: string): HTMLElement {
  return element("a", { href: routeTo(site, version), translate: false }, version ?? site);
}

/** Section with a table, or with a sentence if it has no rows. */
function table(name: string, none: string, heads: string[], rows: Cell[][]): HTMLElement {
  const section = element("section", { class: "listing", ariaLabel: name }, element("h2", {}, name));
  if (rows.length === 0) {
    section.append(element("p", { class: "none" }, none));
    return section;
  }
  const row = ([first, ...cells]: Cell[]) =>
    element("tr", {}, element("th", { scope: "row" }, first), ...cells.map((cell) => element("td", {}, cell)));
  const head = element("tr", {}, ...heads.map((text) => element("th", { scope: "col" }, text)));
  const body = element("tbody", {}, ...rows.slice(0, kMostRows).map(row));
  section.append(element("table", {}, element("thead", {}, head), body));
  const rest = rows.length - kMostRows;
  if (rest > 0) section.append(element("p", { class: "none" }, `${rest} older ones are not shown`));
  return section;
}

export function sitesTable(sites: SiteSummary[]): HTMLElement {
  const heads = ["Site", "Accepted", "Proposed", "Open sessions", "Jobs", "Jobs set aside"];
  const rows = sites.map((each) => [
    linkTo(each.site),
    each.accepted ? linkTo(each.site, each.accepted) : "none",
    ...[each.proposed, each.open_sessions, each.jobs, each.failed_jobs].map(String),
  ]);
  return table("Sites", "The registry has no site that this account may read.", heads, rows);
}

export function versionsTable(site: string, versions: SiteFields["versions"]): HTMLElement {
  const heads = ["Version", "State", "Made of", "Note", "Proposed by", "Proposed at", "Review"];
  const rows = versions.map((each) => [
    linkTo(site, each.id),
    stateOf(each.state),
    each.parent ? linkTo(site, each.parent) : "",
    given(each.note),
    given(each.added_by),
    timeOf(each.added_at),
    given(each.reviewed_by ? `${each.reviewed_by}: ${each.reason ?? ""}` : ""),
  ]);
  return table("Versions", "No version that this account may read.", heads, rows);
}

export function sessionsTable(
  site: string,
  name: string,
  sessions: (SessionFields & { added_at?: string })[],
): HTMLElement {
  const rows = sessions.map((each) => [
    given(each.id),
    given(each.name),
    linkTo(site, each.ran_on),
    given(each.added_by),
    each.added_at ? timeOf(each.added_at) : "",
  ]);
  return table(name, "No sessions.", ["Session", "Name", "Ran on", "Added by", "Added at"], rows);
}

export function plansTable(plans: SiteFields["plans"]): HTMLElement {
  const rows = plans.map((each) => [
    given(`${each.name} ${each.number}`),
    given(each.file),
    given(each.note),
    given(each.added_by),
    timeOf(each.added_at),
  ]);
  return table("Floor plans", "No floor plans.", ["Floor plan", "File", "Note", "Added by", "Added at"], rows);
}

export function jobsTable(jobs: SiteFields["jobs"]): HTMLElement {
  const rows = jobs.map((each) => [
    String(each.id),
    each.kind,
    each.state === "failed" ? "set aside" : each.state,
    String(each.attempts),
    given(each.worker ?? ""),
    given(each.message),
  ]);
  return table("Jobs", "No jobs wait or run.", ["Job", "Kind", "State", "Attempts", "Worker", "Message"], rows);
}

export function robotsTable(site: string, robots: SiteFields["robots"]): HTMLElement {
  const rows = robots.map((each) => [
    given(each.account),
    each.runs ? linkTo(site, each.runs) : "",
    each.seen_at ? timeOf(each.seen_at) : "never",
    String(each.waiting),
    given(each.refused ? `${each.refused}: ${each.reason}` : ""),
  ]);
  const heads = ["Robot", "Runs", "Last contact", "Sessions not sent", "Refuses"];
  return table("Robots", "No robots.", heads, rows);
}

export function eventsTable(events: EventFields[]): HTMLElement {
  const withSubject = events.some(({ subject }) => subject !== undefined);
  const rows = events.map((each) => [
    timeOf(each.at),
    each.kind,
    ...(withSubject ? [given(each.subject ?? "")] : []),
    given(each.actor),
    given(each.reason),
  ]);
  const heads = ["Time", "Event", ...(withSubject ? ["Subject"] : []), "By", "Reason"];
  return table("History", "No events that this account may read.", heads, rows);
}
