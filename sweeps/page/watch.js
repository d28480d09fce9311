// The next version of the page, as soon as the file is saved.
(() => {
  const headers = { "If-None-Match": `"${document.body.dataset.version}"` }, ended = document.getElementById("ended");
  const follow = async () => {
    try {
      // The server answers when there is a new version, or after a while.
      const { status } = await fetch(location.pathname, { headers, cache: "no-store" });
      if (status === 200) {
        page.shown.dispatchEvent(new Event("leave"));
        location.reload();
        return;
      }
      ended.hidden = true;
      setTimeout(follow, status === 304 ? 0 : 1000);
    } catch {
      ended.hidden = false;
      setTimeout(follow, 1000);
    }
  };
  follow();
})();
