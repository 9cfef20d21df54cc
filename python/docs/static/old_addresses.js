// The Python reference was one page: an address of a name that was on it leads to where that name is now.
(() => {
  const name = decodeURIComponent(location.hash.slice(1));
  if (!name.startsWith("pdoik.") || document.getElementById(name)) return;
  document.addEventListener("DOMContentLoaded", () => {
    const links = [...document.querySelectorAll("article a[href]")];
    const owner = links
      .filter((link) => `${name}.`.startsWith(`${link.hash.slice(1)}.`))
      .sort((a, b) => b.hash.length - a.hash.length)[0];
    if (owner && !document.getElementById(name)) location.replace(owner.href.split("#")[0] + "#" + name);
  });
})();
