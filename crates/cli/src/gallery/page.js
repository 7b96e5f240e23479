const root = document.documentElement;
const remember = (theme) => { try { localStorage.setItem("theme", theme); } catch { /* a page on disk may not */ } };
try { const theme = localStorage.getItem("theme"); if (theme) root.dataset.theme = theme; } catch { /* likewise */ }
document.querySelector(".theme").addEventListener("click", () => {
  const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  root.dataset.theme = dark ? "light" : "dark";
  remember(root.dataset.theme);
});
for (const button of document.querySelectorAll(".recipe button")) {
  button.addEventListener("click", async () => {
    const code = button.closest(".recipe").querySelector("code");
    let done = true;
    try { await navigator.clipboard.writeText(code.textContent); } catch {
      const range = document.createRange();
      range.selectNodeContents(code);
      getSelection().removeAllRanges();
      getSelection().addRange(range);
      done = document.execCommand("copy");
    }
    button.textContent = done ? "Copied" : "Press Ctrl+C";
    setTimeout(() => { button.textContent = "Copy"; }, 1600);
  });
}
