// The table as a heatmap: a row a state, a column a move. Read by pointer, finger and keys, one cell at a time.
import { useLayoutEffect, useRef, useState } from "preact/hooks";
import { valueColours } from "../../../js/scale.js";
import {
  cellInWords, colourScale, columnOf, moveOf, stateCells, stateIndex, triedMoves, valueRange,
} from "../steps.js";
import { inMillimetres, percentage, sentence, whole } from "../../../js/format.js";
import { html } from "../../../js/components/elements.js";
import { ChosenStateNote } from "./chosen-state.js";
import { Cells, Feet, ROW_PX, widthOfFeet } from "./table-drawing.js";

/** @import { StateTable } from "../../../js/types.js" */
/** @import { ChosenState } from "../posture.js" */
/** @import { Scale } from "./table-drawing.js" */

const PAGE_ROWS = 10;

/** @typedef {{ row: number, column: number }} Place */
/** @typedef {PointerEvent & { currentTarget: HTMLElement }} OnGrid */

/** @type {Record<string, (place: Place, last: Place) => Partial<Place>>} */
const KEYS = {
  ArrowLeft: ({ column }) => ({ column: column - 1 }),
  ArrowRight: ({ column }) => ({ column: column + 1 }),
  ArrowUp: ({ row }) => ({ row: row - 1 }),
  ArrowDown: ({ row }) => ({ row: row + 1 }),
  PageUp: ({ row }) => ({ row: row - PAGE_ROWS }),
  PageDown: ({ row }) => ({ row: row + PAGE_ROWS }),
  Home: () => ({ column: 0 }),
  End: (_, last) => ({ column: last.column }),
};

/** @param {number} value @param {number} last */
const clamped = (value, last) => Math.min(Math.max(value, 0), last);

/**
 * @param {object} props
 * @param {import("../../../js/types.js").StateTable} props.shown
 * @param {number[] | null} props.cells the state that is looked at: the cell of each pair
 * @param {import("../../../js/types.js").Move | null} props.move the move that was made there
 * @param {import("../posture.js").ChosenState | null} props.chosen the state and move that were chosen with a click
 * @param {(cells: number[], move: import("../../../js/types.js").Move) => void} props.onChoose
 * @param {() => void} props.onGiveUp
 */
export function Heatmap({ shown, cells, move, chosen, onChoose, onGiveUp }) {
  const [read, setRead] = useState(/** @type {Place | null} */ (null));
  const last = { row: shown.values.length - 1, column: shown.values[0].length - 1 };
  const marked = rowOf(cells, shown);
  const column = move && marked !== null ? columnOf(move, shown) : null;
  const chosenRow = rowOf(chosen?.cells ?? null, shown);
  const chosenCell = chosen && chosenRow !== null ? { row: chosenRow, column: columnOf(chosen.move, shown) } : null;
  const at = read ?? chosenCell ?? { row: marked ?? 0, column: column ?? 0 };
  const place = { row: clamped(at.row, last.row), column: clamped(at.column, last.column) };
  const words = cellInWords(shown, place.row, place.column);
  const scale = colourScale(valueRange(shown));
  /** @param {Place} cell */
  const choose = (cell) => onChoose(stateCells(shown.first + cell.row, shown), moveOf(cell.column, shown));
  /** @param {Event & { currentTarget: HTMLElement }} event */
  const giveUp = (event) => {
    /** @type {HTMLElement | null | undefined} */
    const grid = event.currentTarget.closest(".heat")?.querySelector("[role=grid]");
    grid?.focus({ preventScroll: true });
    setRead(null);
    onGiveUp();
  };
  /** @param {KeyboardEvent & { currentTarget: HTMLElement }} event */
  const onKeyDown = (event) => {
    if (event.key !== "Escape" || !chosen) return;
    event.preventDefault();
    giveUp(event);
  };
  return html`
    <div class="heat" onKeyDown=${onKeyDown}>
      <p class="heat-read" data-testid="heat-read">
        <b>${sentence(words.move)}: ${words.worth}</b><span class="dim">, ${words.about}</span>
        <span class="dim heat-state">where ${words.state}</span>
      </p>
      <${ChosenStateNote} chosen=${chosen} grid=${shown} isRead=${place.row === chosenCell?.row} onGiveUp=${giveUp} />
      <${Columns} shown=${shown} />
      <${Grid} shown=${shown} last=${last} place=${place} words=${words} marked=${marked} column=${column}
        chosen=${chosen} held=${chosenCell} onPlace=${setRead} onChoose=${choose}
        isChosen=${(read ?? chosenCell) !== null} scale=${scale} />
      <${Key} shown=${shown} scale=${scale} />
    </div>
  `;
}

/**
 * The row of a state; null where it is not among those that are shown.
 * @param {number[] | null} cells
 * @param {StateTable} shown
 */
function rowOf(cells, shown) {
  if (cells === null) return null;
  const row = stateIndex(cells, shown.cell_names.length) - shown.first;
  return row >= 0 && row < shown.values.length ? row : null;
}

/**
 * The cells, with frames around the state that is looked at, the move made there, the cell that is read, and the state
 * that was chosen.
 * @param {object} props
 * @param {StateTable} props.shown
 * @param {Place} props.last
 * @param {Place} props.place
 * @param {ReturnType<typeof cellInWords>} props.words
 * @param {(place: Place | null) => void} props.onPlace
 * @param {(place: Place) => void} props.onChoose
 * @param {boolean} props.isChosen
 * @param {ChosenState | null} props.chosen
 * @param {Place | null} props.held
 * @param {number | null} props.marked
 * @param {number | null} props.column
 * @param {Scale} props.scale
 */
function Grid({ shown, last, place, words, onPlace, onChoose, isChosen, chosen, held, marked, column, scale }) {
  const scroller = useRef(/** @type {HTMLElement | null} */ (null));
  useLayoutEffect(() => {
    if (marked !== null && !isChosen) scrollTo(scroller.current, marked);
  }, [marked, shown.first, isChosen]);
  const heldRow = held?.row ?? null;
  useLayoutEffect(() => {
    if (heldRow === null) return;
    scrollTo(scroller.current, heldRow);
    const heatmap = scroller.current?.closest(".heat");
    if (chosen?.from === "scene") heatmap?.scrollIntoView({ block: "nearest" });
  }, [heldRow, held?.column, chosen?.from]);
  /** @param {KeyboardEvent} event */
  const onKeyDown = (event) => {
    if (event.key === "Enter") onChoose(place);
    const next = placeByKey(event, place, last);
    // The heatmap around it gives up what was chosen.
    if (next === undefined || (next === null && chosen)) return;
    event.preventDefault();
    event.stopPropagation();
    onPlace(next);
    if (next) scrollTo(scroller.current, next.row);
  };
  const label = `Values of ${whole(shown.values.length)} states; arrow keys read other cells, ` +
    "Enter puts a ghost of the robot into the state";
  return html`
    <div class="heat-scroll" ref=${scroller}>
      <div class="heat-rows">
        <${Feet} shown=${shown} />
        <div class="heat-body" role="grid" tabindex="0" aria-label=${label}
          aria-rowcount=${shown.states} aria-colcount=${last.column + 1} aria-activedescendant=${idOf(place)}
          style=${{ height: `${ROW_PX * (last.row + 1)}px` }} onKeyDown=${onKeyDown} onBlur=${() => onPlace(null)}
          ...${pointerHandlers(last, onPlace, onChoose, held !== null)}>
          <${Cells} shown=${shown} scale=${scale} />
          ${marked !== null && html`<${Frame} name="heat-row" row=${marked} last=${last} />`}
          ${held && heldRow !== marked && html`<${Frame} name="heat-chosen" row=${held.row} last=${last} />`}
          ${column !== null && html`<${Frame} name="heat-move" row=${marked} column=${column} last=${last} />`}
          ${isChosen && html`<${Frame} name="heat-cell" ...${place} last=${last} />`}
          <div role="row" class="sr-only" aria-label=${sentence(words.state)}
            aria-rowindex=${shown.first + place.row + 1}>
            <div role="gridcell" id=${idOf(place)} key=${idOf(place)} aria-colindex=${place.column + 1}
              aria-selected=${place.row === heldRow ? "true" : "false"}>
              ${words.move} where ${words.state}: ${words.worth}, ${words.about}
            </div>
          </div>
        </div>
      </div>
    </div>
  `;
}

/**
 * The place that a key goes to; null gives the choice up, and undefined is for another key.
 * @param {KeyboardEvent} event
 * @param {Place} place
 * @param {Place} last
 */
function placeByKey({ key, ctrlKey, altKey, metaKey }, place, last) {
  if (ctrlKey || altKey || metaKey) return undefined;
  if (key === "Escape") return null;
  const go = KEYS[key];
  if (!go) return undefined;
  const next = { ...place, ...go(place, last) };
  return { row: clamped(next.row, last.row), column: clamped(next.column, last.column) };
}

/**
 * @param {Place} last
 * @param {(place: Place | null) => void} onPlace
 * @param {(place: Place) => void} onChoose
 * @param {boolean} isHeld
 */
function pointerHandlers(last, onPlace, onChoose, isHeld) {
  /** @param {OnGrid} event */
  const placeAt = ({ currentTarget, clientX, clientY }) => {
    const { left, top, width, height } = currentTarget.getBoundingClientRect();
    return width > 0 && height > 0 ? {
      row: clamped(Math.floor(((clientY - top) / height) * (last.row + 1)), last.row),
      column: clamped(Math.floor(((clientX - left) / width) * (last.column + 1)), last.column),
    } : null;
  };
  /** @param {OnGrid} event */
  const read = (event) => {
    const place = placeAt(event);
    if (place) onPlace(place);
  };
  /** @param {OnGrid} event */
  const choose = (event) => {
    const place = placeAt(event);
    if (place) onChoose(place);
  };
  /** @param {OnGrid} event */
  const leave = ({ pointerType, currentTarget }) => {
    // A finger that is lifted leaves the cell until another is touched.
    if (pointerType === "mouse" && (isHeld || document.activeElement !== currentTarget)) onPlace(null);
  };
  return { onPointerMove: read, onPointerDown: read, onPointerLeave: leave, onClick: choose };
}

/** @param {Place} place */
const idOf = ({ row, column }) => `heat-${row}-${column}`;

/** @param {HTMLElement | null} scroller @param {number} row */
function scrollTo(scroller, row) {
  if (!scroller) return;
  const top = row * ROW_PX;
  const room = scroller.clientHeight;
  if (top < scroller.scrollTop || top + ROW_PX > scroller.scrollTop + room) {
    scroller.scrollTop = top - room / 2;
  }
}

/**
 * A frame around a cell, or without a column around a row.
 * @param {{ name: string, row: number, column?: number | null, last: Place }} props
 */
function Frame({ name, row, column = null, last }) {
  /** @param {number} count @param {number} all */
  const share = (count, all) => `${(100 * count) / (all + 1)}%`;
  const across = column === null
    ? { left: 0, width: "100%" }
    : { left: share(column, last.column), width: share(1, last.column) };
  return html`<i class=${name} style=${{ top: `${row * ROW_PX}px`, height: `${ROW_PX}px`, ...across }}></i>`;
}

/** @param {{ shown: StateTable }} props */
const Columns = ({ shown }) => html`
  <div class="heat-columns dim" aria-hidden="true" style=${{ paddingLeft: `${widthOfFeet(shown)}px` }}>
    ${shown.pairs.map((legs) => html`<span>Legs ${legs.join(" + ")}</span>`)}
  </div>
`;

/** @param {{ shown: StateTable, scale: Scale }} props */
function Key({ shown, scale: { low, high } }) {
  const { tried, all } = triedMoves(shown);
  const steps = [0, 0.25, 0.5, 0.75, 1];
  const stops = steps.map((share) => valueColours(share, 0, 1).background);
  return html`
    <p class="values-key dim">
      <span><i class="untried" aria-hidden="true"></i>never tried</span>
      <span>${inMillimetres(low)}
        <i class="heat-scale" aria-hidden="true" style=${{ background: `linear-gradient(90deg, ${stops})` }}></i>
        ${inMillimetres(high)}</span>
      <span>• best move of its state</span>
      <span>– where they stand</span>
      <span>${percentage(tried / all)} of ${whole(all)} moves tried</span>
    </p>
  `;
}
