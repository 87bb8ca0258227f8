/** Shows each scene of a page, which is in a script of its own, once the reader comes near to it. */
(viewer) => {
  /** @type {Map<string, Promise<any>>} meshes that several scenes of a page may have */
  const meshes = new Map();

  /** Files may load nothing but scripts: this one puts its bytes into its own element. @param {string} address */
  async function fromScript(address) {
    const script = document.createElement("script");
    script.src = address;
    await new Promise((resolve, reject) => {
      script.onload = resolve;
      script.onerror = () => reject(`${script.src} is missing.`);
      document.head.append(script);
    });
    script.remove();
    return viewer.unpacked(script.dataset.content);
  }

  /** @param {string} address */
  function mesh(address) {
    const found = meshes.get(address) ?? fromScript(address);
    meshes.set(address, found);
    return found;
  }

  /** @param {HTMLElement} host */
  async function show(host) {
    const address = host.dataset.scene;
    try {
      const content = await fromScript(address);
      const commands = (content.batches ?? [content]).flatMap((batch) => batch.commands ?? []);
      const named = commands.filter((command) => command.object?.shared);
      await Promise.all(named.map(async (command) => {
        command.object = await mesh(address.replace(/[^/]*$/, `${command.object.shared}.js`));
      }));
      viewer.mount(host, content);
    } catch (error) {
      host.append(`The 3D view cannot be shown: ${error}`);
    }
  }

  const near = new IntersectionObserver((entries) => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      near.unobserve(target);
      show(target);
    }
  }, { rootMargin: "300px" });
  for (const host of document.querySelectorAll(".course-scene[data-scene]")) near.observe(host);
}
