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

  /** Reads a mesh as `compact.py` writes it: columns, of numbers that are differences. @param {any} coded */
  function expanded({ corner, step, steps, turns, corners, ...mesh }) {
    const [places, ways] = [new Int16Array(steps.slice().buffer), new Int8Array(turns.slice().buffer)];
    const [vertices, normals] = [new Float32Array(places.length), new Float32Array(places.length)];
    const count = places.length / 3;
    for (let column = 0; column < 3; column++) {
      for (let row = 0, at = 0; row < count; row++) {
        at += places[column * count + row];
        vertices[3 * row + column] = corner[column] + step * at;
        normals[3 * row + column] = ways[column * count + row] / 16;
      }
    }
    const numbers = new Int16Array(corners.slice().buffer);
    const faces = new Uint32Array(numbers.length);
    const most = numbers.length / 3;
    for (let row = 0, first = 0; row < most; row++) {
      first += numbers[row];
      faces.set([first, first + numbers[most + row], first + numbers[2 * most + row]], 3 * row);
    }
    return { ...mesh, vertices, normals, faces };
  }

  /** @param {string} address */
  function mesh(address) {
    const found = meshes.get(address) ?? fromScript(address).then(expanded);
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
