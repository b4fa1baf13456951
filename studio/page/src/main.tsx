/** The page. */

import { render } from "preact";
import { useEffect } from "preact/hooks";
import "uplot/dist/uPlot.min.css";
import "./style.css";
import "./report.css";
import { Effects, Parameters } from "./effects";
import { drawFigures } from "./figures";
import { Failures } from "./heat";
import { useStore } from "./hooks";
import { Errors, Exports, Guide, History, Next } from "./panels";
import { PlanMap } from "./plan";
import { Scene } from "./scene";
import { Signals } from "./signals";
import { store } from "./store";
import { Together } from "./together";
import { Opening } from "./upload";
import { Windows } from "./windows";

function Header() {
  const { experiment, listed, connected } = useStore();
  return (
    <header>
      <a class="skip" href="#signals" onClick={(event) => { event.preventDefault(); document.getElementById("signals")?.scrollIntoView(); }}>To the plots</a>
      {store.saved ? <span class="brand">Bekker</span> : <h1>Bekker workbench</h1>}
      {listed && listed.experiments.length > 1 ? (
        <label>
          <span class="unseen">Experiment</span>
          <select value={experiment?.id} onChange={(event) => void store.openExperiment(event.currentTarget.value)}>
            {listed.experiments.map((one) => <option key={one.id} value={one.id}>{one.name}</option>)}
          </select>
        </label>
      ) : <span class="title">{experiment?.name}</span>}
      {store.saved ? <a href="#report">The whole argument</a> : <><Together /><Opening /></>}
      {!connected && <span class="flag" role="status">connection lost, trying again…</span>}
    </header>
  );
}

function Notes() {
  const { experiment } = useStore();
  if (!experiment) return null;
  const notes = [...experiment.doubts, ...experiment.sources, ...(experiment.calibration?.cautions ?? [])];
  if (notes.length === 0) return null;
  return (
    <details class="card">
      <summary><h2>{notes.length} {notes.length === 1 ? "note" : "notes"} on the measurements</h2></summary>
      <ul>{notes.map((note) => <li key={note}>{note}</li>)}</ul>
    </details>
  );
}

function Page() {
  const { error, experiment } = useStore();
  useEffect(() => void store.start(), []);
  useEffect(() => {
    if (store.saved) return;
    document.title = experiment ? `${experiment.name} – Bekker workbench` : "Bekker workbench";
  }, [experiment?.name]);
  useEffect(() => {
    const key = (event: KeyboardEvent) => {
      const typing = event.target instanceof HTMLElement && event.target.closest("input:not([type=range]):not([type=checkbox]), textarea");
      if ((event.ctrlKey || event.metaKey) && event.key === "z" && !typing) {
        event.preventDefault();
        history.back();
      }
    };
    document.addEventListener("keydown", key);
    return () => document.removeEventListener("keydown", key);
  }, []);
  return (
    <>
      <Header />
      {error && (
        <div class="error" role="alert">
          <p>{error}</p>
          <button type="button" onClick={() => { store.error = null; store.changed(); }}>Dismiss</button>
        </div>
      )}
      <main>
        <div class="side">
          <Guide />
          <Errors />
          <Effects />
        </div>
        <div class="wide">
          <PlanMap />
          <Signals />
          <Windows />
          <div class="pair"><Scene /><Failures /></div>
          <div class="pair">
            <div><History /><Parameters /></div>
            <div>
              <Next />
              <section class="card" aria-labelledby="save"><h2 id="save">Save</h2><Exports /></section>
              <Notes />
            </div>
          </div>
        </div>
      </main>
    </>
  );
}

declare global {
  interface Window { bekker: typeof store }
}
// For tests in a browser and for people who look behind the page.
window.bekker = store;

/** Links within a report go to their place and leave the address to the state of the page. */
function follow(event: MouseEvent): void {
  const link = event.target instanceof Element ? event.target.closest<HTMLAnchorElement>("a[href^='#']") : null;
  const place = link && document.getElementById(link.hash.slice(1));
  if (!place) return;
  event.preventDefault();
  for (let above = place.parentElement; above; above = above.parentElement) if (above instanceof HTMLDetailsElement) above.open = true;
  place.scrollIntoView();
  place.tabIndex = -1;
  place.focus({ preventScroll: true });
}

const report = document.getElementById("report");
if (report) {
  document.addEventListener("click", follow);
  drawFigures();
}
const place = document.getElementById("page");
if (place && (store.saved || !report)) {
  place.textContent = "";
  render(<Page />, place);
}
