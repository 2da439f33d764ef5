"use strict";
// Filter the claims by verdict and place. The choice is kept in the address, as in
// #verdict=not-reproduced&place=Fig.+17, so that it can be passed on; #claim-KEY, #erratum-KEY and
// #figure-NAME open the row that they are in.
(() => {
  const rows = [...document.querySelectorAll("#claims > li")];
  const folds = rows.map((row) => row.querySelector("details"));
  const verdict = document.getElementById("verdict");
  const place = document.getElementById("place");
  const shown = document.getElementById("shown");
  const unfold = document.getElementById("unfold");
  const plain = (text) => text.toLowerCase().replace(/\s+/g, " ").trim();
  const text = (row, part) => row.querySelector(`summary .${part}`).textContent;

  // "Eqs. (3), (6)", "eq03", "Equation 3" and "(3)" all name equation 3. Numbers match whole;
  // a section holds its parts; other words match from their beginning.
  const kinds = { eq: "eq", eqs: "eq", equation: "eq", equations: "eq", fig: "fig", figs: "fig",
    figure: "fig", figures: "fig", sec: "section", section: "section", sections: "section" };
  const links = new Set(["and", "to", "or", "a", "b", "c"]);
  function index(words) {
    const found = { words: [], named: [] };
    let kind = "";
    const text = words.toLowerCase().replace(/§/g, " section ").replace(/_/g, "")
      .replace(/\(0*(\d+)\)/g, " eq $1 ");
    for (const token of text.match(/\d+(?:\.\d+)*|\p{L}+/gu) || []) {
      if (/^\d/.test(token)) {
        const number = token.replace(/^0+(?=\d+$)/, "");
        if (kind) found.named.push(`${kind} ${number}`);
        found.words.push(number);
      } else if (Object.hasOwn(kinds, token)) {
        kind = kinds[token];
        found.words.push(kind);
      } else {
        if (!links.has(token)) kind = "";
        found.words.push(token);
      }
    }
    return found;
  }
  const texts = rows.map((row) => index(
    `${text(row, "place")} ; ${text(row, "claim")} ; ${row.id.replace(/^claim-/, "")}`));

  function matches(entry, asked) {
    const numbers = new Set(asked.named.map((name) => name.split(" ")[1]));
    return asked.named.every((name) => entry.named.some((one) => one === name
        || (name.startsWith("section ") && one.startsWith(`${name}.`))))
      && asked.words.every((word) => numbers.has(word) || (/^\d/.test(word)
        ? entry.words.includes(word)
        : entry.words.some((one) => one.startsWith(word))));
  }

  function apply() {
    const words = plain(place.value);
    const asked = index(words);
    const empty = words !== "" && asked.words.length === 0;
    let count = 0;
    rows.forEach((row, i) => {
      const fits = !verdict.value || row.dataset.verdict === verdict.value;
      row.hidden = !(fits && !empty && matches(texts[i], asked));
      count += row.hidden ? 0 : 1;
    });
    shown.textContent = `${count} of ${rows.length} shown`;
    document.getElementById("none").hidden = count > 0;
  }

  function remember() {
    const choice = new URLSearchParams();
    if (verdict.value) choice.set("verdict", verdict.value);
    if (place.value.trim()) choice.set("place", place.value.trim());
    history.replaceState(null, "", `#${choice}`);
  }

  function choose(name, words) {
    verdict.value = name;
    if (verdict.selectedIndex < 0) verdict.value = "";
    place.value = words;
    apply();
  }

  function follow() {
    const hash = location.hash.slice(1);
    if (/^(claim|erratum|figure)-/.test(hash)) {
      const target = document.getElementById(hash);
      const row = target && target.closest(".rows > li");
      if (!row) return;
      if (row.hidden) choose("", "");
      row.querySelector("details").open = true;
      target.scrollIntoView();
      row.querySelector("summary").focus({ preventScroll: true });
    } else if (/^(verdict|place)=/.test(hash)) {
      const choice = new URLSearchParams(hash);
      choose(choice.get("verdict") || "", choice.get("place") || "");
      document.getElementById("claims-title").scrollIntoView();
    }
  }

  for (const control of [verdict, place]) {
    control.addEventListener("input", () => {
      apply();
      remember();
    });
  }
  unfold.addEventListener("click", () => {
    const open = unfold.getAttribute("aria-pressed") !== "true";
    unfold.setAttribute("aria-pressed", String(open));
    unfold.textContent = open ? "Close all" : "Open all";
    folds.forEach((fold) => { fold.open = open; });
  });
  document.getElementById("filter").addEventListener("submit", (event) => event.preventDefault());

  addEventListener("hashchange", follow);

  document.getElementById("filter").hidden = false;
  choose("", "");
  follow();
})();
