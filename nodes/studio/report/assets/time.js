// The horizontal axis of all plots against time.
"use strict";
document.querySelectorAll("[data-show]").forEach((button) => button.addEventListener("click", () => {
  document.querySelectorAll("[data-show]").forEach((b) => b.setAttribute("aria-pressed", b === button));
  document.getElementById("curves").classList.toggle("by-time", button.dataset.show === "time");
}));
