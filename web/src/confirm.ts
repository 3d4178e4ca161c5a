import { element } from "./dom";

/** Dialog before a step that is hard to undo; Enter selects no. True if confirmed. */
export function isConfirmed(question: string, yes: string, no: string): Promise<boolean> {
  const refuse = element("button", { type: "button", autofocus: true }, no);
  const accept = element("button", { type: "button", class: "danger" }, yes);
  const dialog = element(
    "dialog",
    { class: "confirm", ariaLabel: "Confirmation" },
    element("p", {}, question),
    element("p", { class: "buttons" }, refuse, accept),
  );
  document.body.append(dialog);
  return new Promise((resolve) => {
    refuse.addEventListener("click", () => dialog.close());
    accept.addEventListener("click", () => dialog.close("yes"));
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(dialog.returnValue === "yes");
    });
    dialog.showModal();
  });
}
