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
  const texts = rows.map((row) => plain(`${text(row, "place")} ${text(row, "claim")} ${row.id}`));

  function apply() {
    const words = plain(place.value);
    let count = 0;
    rows.forEach((row, i) => {
      const fits = !verdict.value || row.dataset.verdict === verdict.value;
      row.hidden = !(fits && texts[i].includes(words));
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

  let closed = [];
  addEventListener("beforeprint", () => {
    closed = [...document.querySelectorAll("details")].filter((fold) => !fold.open);
    closed.forEach((fold) => { fold.open = true; });
  });
  addEventListener("afterprint", () => closed.forEach((fold) => { fold.open = false; }));
  addEventListener("hashchange", follow);

  document.getElementById("filter").hidden = false;
  choose("", "");
  follow();
})();
