// The view of Python's Slider: its name, the browser's range control, and its value as a number.

const TRAITS = ["description", "description_width", "min", "max", "step", "value", "disabled"];

/** @param {string} type */
const input = (type) => Object.assign(document.createElement("input"), { type });

export default {
  /** @param {{model: any, el: HTMLElement}} props */
  render({ model, el }) {
    const name = document.createElement("span");
    const [range, number, label] = [input("range"), input("number"), document.createElement("label")];
    label.append(name, range); // so that the label belongs to the range
    el.append(label, number);
    el.classList.add("course-slider");
    el.addEventListener("keydown", (event) => {
      if (!event.ctrlKey && !event.metaKey && !event.altKey) event.stopPropagation(); // these keys must not reach the notebook
    });

    const show = () => {
      const state = Object.fromEntries(TRAITS.map((trait) => [trait, model.get(trait)]));
      const { description, min, max, step, value, disabled } = state;
      name.textContent = description;
      name.style.width = state.description_width;
      number.ariaLabel = `${description}, as a number`;
      for (const one of [range, number]) Object.assign(one, { min, max, step: step || 1, disabled });
      range.value = value; // after the limits, which would change it otherwise
      write(value);
    };
    const write = (/** @type {number} */ value) => {
      const decimals = model.get("decimals");
      number.value = range.ariaValueText = (Number(value.toFixed(decimals)) || 0).toFixed(decimals); // never -0
    };
    /** @param {number} value chosen by the user; it may be NaN */
    const choose = (value) => {
      const whole = Number.isInteger(model.get("step")) ? Math.round(value) : value;
      if (Number.isFinite(whole)) {
        model.set("value", Math.min(model.get("max"), Math.max(model.get("min"), whole)));
        model.save_changes();
      }
      show();
    };
    range.oninput = () => (model.get("is_live") ? choose : write)(range.valueAsNumber);
    range.onchange = () => model.get("is_live") || choose(range.valueAsNumber);
    number.onchange = () => choose(number.valueAsNumber);
    model.on("change", show);
    show();
    return () => model.off("change", show);
  },
};
