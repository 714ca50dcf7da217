// How the scene looks in the theme of its viewer, who shares it with others: lights, tones, materials, grid, tints,
// shadows, and where the horizon is behind the transparent canvas (patch.css draws it).
// Assumptions about viser's client are listed and tested in hexapods/drawing/viser_internals.
(() => {
  "use strict";

  const root = document.documentElement;
  const prefersDark = matchMedia("(prefers-color-scheme: dark)");
  const themeNow = () => root.dataset.theme ?? (prefersDark.matches ? "dark" : "light");

  const NEUTRAL_TONES = 7; // of three.js: keeps the hues of the agents' colours
  const ROUGHNESS = 0.5;
  const METALNESS = 0.12;
  /** Later in the order of drawing, of what is translucent. */
  const ORDER = { grid: -2, tint: -1, shadow: 2 };

  const THEMES = {
    light: {
      "/lamp": { intensity: 1.9, color: "#fff6ea" },
      "/rim": { intensity: 0.7, color: "#ffffff" },
      "/sky": { intensity: 1.9, color: "#ffffff", groundColor: "#d5dae2" },
      grid: "#b4bfce", tint: "#ffffff", marks: "#6d7a8e", cells: 1.165, shadow: 0.42, antenna: 1.1,
    },
    dark: {
      "/lamp": { intensity: 2.5, color: "#fff6ea" },
      "/rim": { intensity: 1.4, color: "#dde9ff" },
      "/sky": { intensity: 1.25, color: "#f2f5ff", groundColor: "#4c5364" },
      grid: "#2d3644", tint: "#2a3342", marks: "#93a1b6", cells: 1.25, shadow: 0.75, antenna: 2.2,
    },
  };
  /** Ghosts are translucent, and so is what they cast. */
  const GHOST_SHADOW = 0.45;

  const unlit = (mesh, color) => {
    mesh.material.toneMapped = false;
    mesh.material.color.set(color);
  };

  /** What is done with the meshes of scene nodes whose names end in this way. */
  const LOOKS = [
    [/^\/(lamp|rim|sky)$/, (light, theme, name) => {
      const { intensity, color, groundColor } = theme[name];
      light.intensity = intensity;
      light.color.set(color);
      if (groundColor) light.groundColor.set(groundColor);
    }],
    [/\/world\/ground$/, (mesh, theme) => {
      mesh.renderOrder = ORDER.grid;
      mesh.material.uniforms?.sectionColor?.value.set(theme.grid);
    }],
    [/\/track\/tint\d+$/, (mesh, theme) => {
      mesh.renderOrder = ORDER.tint;
      unlit(mesh, theme.tint);
    }],
    [/\/track\/(marks|distances|distances-from-front)$/, (mesh, theme) => unlit(mesh, theme.marks)],
    [/\/track\/(start|finish)$/, (mesh) => unlit(mesh, "#ffffff")],
    [/\/grid\/(home|others)\/(fills|rims)$/, (mesh, theme) => {
      mesh.material.toneMapped = false;
      // What lies flat is darker in these lights; as much brighter it has the colours of the legend.
      mesh.material.color.setScalar(theme.cells);
    }],
    [/\/(ghost-)?shadows$/, (mesh, theme, name) => {
      mesh.renderOrder = ORDER.shadow;
      mesh.material.depthWrite = false;
      mesh.material.opacity = theme.shadow * (name.endsWith("/ghost-shadows") ? GHOST_SHADOW : 1);
    }],
    [/\/(\d+\/(torso|legs-[\d-]+)|part\/\d+)$/, (mesh, theme, name) => {
      Object.assign(mesh.material, { roughness: ROUGHNESS, metalness: METALNESS });
      if (name === antennaOf(name)) mesh.material.color.setScalar(theme.antenna);
    }],
  ];

  const viewer = () => window.__viserMutable;

  /** The last part of a robot is its antenna: a glow of each robot in its own colour. */
  const antennaOf = (name) => {
    const robots = name.slice(0, name.lastIndexOf("/", name.lastIndexOf("/") - 1) + 1);
    const parts = Object.keys(viewer().nodeRefFromName).filter((other) => other.startsWith(robots));
    const numberOf = (part) => Number(/\/(\d+)\/torso$/.exec(part)?.[1] ?? -1);
    return parts.reduce((last, part) => (numberOf(part) > numberOf(last) ? part : last), "");
  };

  /** Mesh or light → what it is made of and the theme in which it is shown. */
  const shown = new WeakMap();

  const look = (name, change, themeName) => {
    viewer().nodeRefFromName[name]?.traverse((part) => {
      if (!part.material && !part.isLight) return;
      const before = shown.get(part);
      if (before?.material === part.material && before?.themeName === themeName) return;
      shown.set(part, { material: part.material, themeName });
      change(part, THEMES[themeName], name);
      if (part.material) part.material.needsUpdate = true;
    });
  };

  /** By the names of scene nodes, since there are few kinds of them. */
  const changes = new Map();
  const changeOf = (name) => {
    if (!changes.has(name)) changes.set(name, LOOKS.find(([pattern]) => pattern.test(name))?.[1] ?? null);
    return changes.get(name);
  };

  // ---- the horizon

  let horizon = "";
  /** Where the ground ends, from above, in the picture of a camera that does not lean to a side. */
  const placeHorizon = (camera) => {
    const up = viewer().nodeRefFromName["/world"]?.matrixWorld.elements.slice(8, 11);
    if (!up || !camera.isPerspectiveCamera) return;
    const back = camera.matrixWorld.elements.slice(8, 11);
    const sine = back.reduce((sum, part, axis) => sum + part * up[axis], 0) / Math.hypot(...up);
    const tangent = sine / Math.sqrt(Math.max(1e-6, 1 - sine * sine));
    const share = 0.5 * (1 - tangent / Math.tan((camera.fov * Math.PI) / 360));
    const place = `${(100 * Math.min(1, Math.max(0, share))).toFixed(1)}%`;
    if (place === horizon) return;
    horizon = place;
    root.style.setProperty("--horizon", place);
  };

  // ---- the distances on the lanes: of both readings the one that is upright for the camera

  const chooseDistances = (camera) => {
    const { nodeRefFromName } = viewer();
    const nodes = ["distances", "distances-from-front"].map((name) => nodeRefFromName[`/world/run/track/${name}`]);
    if (nodes.includes(undefined) || nodes.includes(null)) return;
    const up = camera.matrixWorld.elements.slice(4, 7);
    const along = nodes[0].matrixWorld.elements.slice(4, 7);
    const isFromFront = up.reduce((sum, part, axis) => sum + part * along[axis], 0) < 0;
    nodes.forEach((node, n) => node.traverse((part) => {
      if (part.material) part.visible = isFromFront === (n === 1);
    }));
  };

  // ---- before each frame that is drawn

  const prepare = (renderer, camera) => {
    renderer.toneMapping = NEUTRAL_TONES;
    const themeName = themeNow();
    for (const name of Object.keys(viewer().nodeRefFromName)) {
      const change = changeOf(name);
      if (change) look(name, change, themeName);
    }
    chooseDistances(camera);
    placeHorizon(camera);
  };

  const attach = () => {
    const { scene } = viewer() ?? {};
    if (!scene) {
      requestAnimationFrame(attach);
      return;
    }
    const before = scene.onBeforeRender; // of camera.js, which places the camera
    scene.onBeforeRender = (...parts) => {
      before.apply(scene, parts);
      const [renderer, , camera] = parts;
      prepare(renderer, camera);
    };
  };
  addEventListener("hexapods:connected", attach);
  prefersDark.addEventListener("change", () => viewer()?.requestRender());
})();
