// The journal in a dialog: all entries, and a field for the next one.
import { signal } from "@preact/signals";
import { useEffect, useState } from "preact/hooks";
import { call } from "../../js/api.js";
import { Dialog, html } from "../../js/components/elements.js";
import { messageOf } from "../../js/titles.js";

const isOpen = signal(false);

export const openJournal = () => (isOpen.value = true);

export const JournalDialog = () => html`
  <${Dialog} id="journal" labelledBy="journal-title" isOpen=${isOpen}>
    ${isOpen.value && html`<${Journal} />`}
  <//>
`;

function Journal() {
  const [entries, setEntries] = useState([]);
  const [text, setText] = useState("");
  const [problem, setProblem] = useState("");
  const perform = (request) => request.then(() => setProblem(""), (error) => setProblem(messageOf(error)));
  const load = () => perform(call("GET", "journal").then(({ items }) => setEntries(items)));
  const write = (event) => {
    event.preventDefault();
    perform(call("POST", "journal", { text }).then(() => setText("")).then(load));
  };
  useEffect(() => void load(), []);
  return html`
    <h2 id="journal-title">Journal</h2>
    <form onSubmit=${write}>
      <label>Next entry <input value=${text} onInput=${({ target }) => setText(target.value)} required /></label>
      <button type="submit">Write</button>
    </form>
    ${problem && html`<p role="alert">${problem}</p>`}
    ${entries.length === 0 && html`<p class="dim">Nothing is written yet.</p>`}
    <ul>${entries.map((entry) => html`<li key=${entry.number}>${entry.text}</li>`)}</ul>
  `;
}
