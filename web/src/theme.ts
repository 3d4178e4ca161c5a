import { byId } from "./dom";

export type Theme = "light" | "dark";

const kStored = "byre-theme";
const listeners: (() => void)[] = [];

function systemTheme(): Theme {
  return matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
}

export function currentTheme(): Theme {
  return document.documentElement.dataset.theme === "dark" ? "dark" : "light";
}

/** Colour of style.css, by the name of its variable without dashes. */
export function colour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

export function onThemeChange(listener: () => void): void {
  listeners.push(listener);
}

function apply(theme: Theme): void {
  document.documentElement.dataset.theme = theme;
  const button = byId("theme");
  button.textContent = theme === "dark" ? "Light" : "Dark";
  for (const listener of listeners) listener();
}

/** Applies the stored theme, by default that of the system. */
export function startTheme(): void {
  const stored = localStorage.getItem(kStored);
  apply(stored === "light" || stored === "dark" ? stored : systemTheme());
  byId("theme").addEventListener("click", () => {
    const next = currentTheme() === "dark" ? "light" : "dark";
    localStorage.setItem(kStored, next);
    apply(next);
  });
}
