import german from "./german.json";

/** Texts of other languages by English text; {} stands for any text, such as a number. */
const kLanguages: Record<string, Record<string, string>> = { de: german };

const kAttributes = ["title", "aria-label", "alt"];

/** Pattern of texts with parts that vary, and their translation. */
interface Form {
  pattern: RegExp;
  translation: string;
}

/** Translates the page without elements of translate="no", now and whenever it changes, to the browser's language or that of ?lang=; English without one. */
export function startLanguage(): void {
  const language = new URLSearchParams(location.search).get("lang") ?? navigator.language.slice(0, 2);
  const texts = kLanguages[language];
  if (!texts) return;
  document.documentElement.lang = language;
  const translate = translator(texts);
  const observer = new MutationObserver((changes) => {
    for (const { target } of changes) visit(target);
    observer.takeRecords(); // the changes by visit
  });
  const visit = (node: Node): void => {
    const owner = node instanceof Text ? node.parentElement : node;
    if (owner instanceof HTMLElement && !owner.translate) return;
    if (node instanceof Text) {
      const text = translate(node.data);
      if (text !== node.data) node.data = text;
      return;
    }
    if (node instanceof Element) {
      for (const name of kAttributes) {
        const text = node.getAttribute(name);
        if (text) node.setAttribute(name, translate(text));
      }
    }
    node.childNodes.forEach(visit);
  };
  visit(document.body);
  observer.observe(document.body, {
    subtree: true,
    childList: true,
    characterData: true,
    attributes: true,
    attributeFilter: kAttributes,
  });
}

function translator(texts: Record<string, string>): (text: string) => string {
  const lengthOfWords = (form: string) => form.replaceAll("{}", "").length;
  const forms: Form[] = Object.entries(texts)
    .filter(([english]) => english.includes("{}"))
    .sort(([a], [b]) => lengthOfWords(b) - lengthOfWords(a)) // the most specific first
    .map(([english, translation]) => ({
      pattern: new RegExp(`^${english.split("{}").map(escaped).join("(.+)")}$`),
      translation,
    }));
  const known = new Map<string, string>();
  const translate = (text: string): string => {
    const exact = texts[text] ?? known.get(text);
    if (exact !== undefined) return exact;
    for (const { pattern, translation } of forms) {
      const found = pattern.exec(text);
      if (!found) continue;
      let part = 0;
      return translation.replace(/{}/g, () => translate(found[++part]));
    }
    if (known.size < 10000) known.set(text, text);
    return text;
  };
  return translate;
}

function escaped(text: string): string {
  return text.replace(/[.*+?^${}()|[\]\\]/g, "\\$&");
}
