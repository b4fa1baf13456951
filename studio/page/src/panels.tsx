/** Error against noise, what to do next, the history, and the next experiment. */

import { useEffect, useRef } from "preact/hooks";
import { give, save } from "./api";
import { canUndo } from "./address";
import { column, listed, quantity, short, spoken, times } from "./format";
import { useStore } from "./hooks";
import { keyOf } from "./memory";
import { AT_NOISE } from "./errors";
import { store } from "./store";
import type { JobKind, Values } from "./types";

/** Ratios are drawn on a scale that gives small ones room: 1 is the noise. */
function place(ratio: number, most: number): number {
  return 100 * Math.sqrt(ratio / most);
}

/** An error and the one before it, on a scale on which the noise is marked. */
function Track({ ratio, old, most, title }: { ratio: number; old: number | null; most: number; title?: string }) {
  return (
    <span class="track" title={title}>
      {old !== null && <i class="old" style={{ width: `${place(old, most)}%` }} />}
      <i class={ratio <= AT_NOISE ? "now good" : "now"} style={{ width: `${place(ratio, most)}%` }} />
      <u style={{ left: `${place(1, most)}%` }} />
    </span>
  );
}

/** Of several experiments on one soil: the error of each and of all, and a choice of the one that is shown. */
function Parts({ before, most }: { before: Values | undefined; most: number }) {
  const { whole, part, trial } = useStore();
  if (!whole || !part || !trial) return null;
  const row = (now: number | null, old: number | null) =>
    now === null ? <span class="soft">noise unknown</span> : <><b class="value">{times(now)} noise</b><Track ratio={now} old={old} most={most} /></>;
  return (
    <fieldset class="parts">
      <legend>Experiments on one soil; the plots show the chosen one</legend>
      {whole.parts.map((one) => (
        <label key={one.part}>
          <input type="radio" name="part" value={one.part} checked={(store.view.part || part.part) === one.part} onChange={() => store.choosePart(one.part)} />
          <span class="name">{one.part}</span>
          {row(store.overallOf(one, trial.rmse), store.overallOf(one, before))}
          {one.name !== one.part && <span class="about">{one.name}</span>}
        </label>
      ))}
      <p>
        <span class="name">all together</span>
        {row(store.overall(trial.rmse), store.overall(before))}
      </p>
    </fieldset>
  );
}

export function Errors() {
  const { experiment, whole, part, trial, steps, view } = useStore();
  if (!experiment || !whole || !trial) return null;
  const before = steps[store.isChanged() ? view.at : (store.step?.parent ?? view.at)]?.rmse;
  const own = experiment.signals.map((signal) => [store.ratio(signal, trial.rmse) ?? 0, store.ratio(signal, before) ?? 0]).flat();
  const ofParts = whole.parts.map((one) => [store.overallOf(one, trial.rmse) ?? 0, store.overallOf(one, before) ?? 0]).flat();
  const most = Math.max(4, ...own, ...ofParts) * 1.05;
  return (
    <section class="card" aria-labelledby="errors">
      <h2 id="errors">Error against the noise</h2>
      <Parts before={before} most={most} />
      {part && <h3>Signals of {part.part}</h3>}
      <ul class="errors">
        {experiment.signals.map((signal) => {
          const ratio = store.ratio(signal, trial.rmse);
          const old = store.ratio(signal, before);
          const shown = column(experiment, signal);
          const floor = experiment.noise[signal];
          return (
            <li key={signal}>
              <span class="name">{shown.name}</span>
              <span class="value">
                {quantity(store.errorOf(signal, trial.rmse), shown)} <b>{ratio === null ? "" : `${times(ratio)} noise`}</b>
              </span>
              {ratio === null ? (
                <span class="soft">noise unknown: no repeats, none stated</span>
              ) : (
                <Track ratio={ratio} old={old} most={most} title={`noise ${quantity(floor?.value, shown)}, from ${floor?.source}`} />
              )}
            </li>
          );
        })}
      </ul>
      <p class="hint">The upright mark is the noise of one measurement: no model can do better. The pale bar is the step before.</p>
    </section>
  );
}

function Bar({ kind }: { kind: JobKind }) {
  const job = store.jobs.get(kind);
  if (!job) return null;
  const share = job.share === undefined ? undefined : Math.round(100 * job.share);
  return (
    <div class="job">
      <progress max={100} value={share} aria-label={job.stage} />
      <span class="soft">
        {job.stage}{job.trying ? `: ${spoken(job.trying)}` : ""}{job.left ? `, ${job.left}` : ""}
      </span>
      <button type="button" onClick={() => void store.stop(kind)}>Stop</button>
    </div>
  );
}

/** The best single effect that was tried so far. */
function best(): string | null {
  const accepted = store.step?.effects ?? [];
  const open = (store.experiment?.effects ?? []).filter(({ id }) => !accepted.includes(id));
  const known = open.map(({ id }) => ({ id, gain: store.gain(id) ?? 0 })).filter(({ gain }) => gain > 25);
  return known.sort((p, q) => q.gain - p.gain)[0]?.id ?? null;
}

/** Of a saved report: its verdict, and what a change by hand does to the error. */
function Verdicts() {
  const { trial, step, view } = useStore();
  const place = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const first = document.getElementById("first");
    if (first && place.current) place.current.append(first);
  }, []);
  const added = view.on.filter((id) => !(step?.effects ?? []).includes(id));
  const gone = (step?.effects ?? []).filter((id) => !view.on.includes(id));
  const instead = gone.length ? ` in the place of ${listed(gone)}` : "";
  const what = added.length ? listed(added) + instead : gone.length ? `no ${listed(gone)}` : "the strength set by hand";
  return (
    <section class="card guide" aria-labelledby="guide">
      <h2 id="guide" class="unseen">Verdict</h2>
      <div aria-live="polite">
        {store.isChanged() && (
          <>
            <p class="answer">{change(what, store.overall(step?.rmse), store.overall(trial?.rmse))}</p>
            <div class="actions"><button type="button" onClick={() => store.goTo(view.at)}>Back to the step</button></div>
          </>
        )}
      </div>
      <div ref={place} />
    </section>
  );
}

/** What to do now, always one thing. */
export function Guide() {
  return store.saved ? <Verdicts /> : <Advice />;
}

function Advice() {
  const { experiment, trial, jobs, diagnosis, view } = useStore();
  if (!experiment || !trial) return <section class="card guide" aria-live="polite"><p>Reading the experiment…</p></section>;
  const now = store.overall(trial.rmse);
  const step = store.step;
  const then = store.overall(step?.rmse);
  const candidate = best();
  const added = view.on.filter((id) => !(step?.effects ?? []).includes(id));
  const ratio = (value: number | null) => (value === null ? "" : `${value.toFixed(1)} times the noise`);
  const atNoise = now !== null && now <= AT_NOISE;
  const find = (words: string) => (
    <button type="button" class="main" onClick={() => void store.begin("rank")}>{words}</button>
  );
  let content;
  if (jobs.has("calibrate")) {
    content = <><p>The model is being calibrated: its soil is fitted to the measurements.</p><Bar kind="calibrate" /></>;
  } else if (!experiment.calibration) {
    content = <><p>The soil is not calibrated to the measurements yet.</p><button type="button" class="main" onClick={() => void store.begin("calibrate")}>Calibrate</button></>;
  } else if (added.length > 0) {
    content = (
      <>
        <p class="answer">
          {change(listed(added), then, now)}
        </p>
        {jobs.has("fit") ? <Bar kind="fit" /> : null}
        <div class="actions">
          <button type="button" class="main" onClick={() => void store.accept()}>Accept {listed(added)}</button>
          <button type="button" onClick={() => store.goTo(view.at)}>Discard</button>
        </div>
        <Bar kind="rank" />
      </>
    );
  } else if (store.isChanged()) {
    content = (
      <>
        <p>You have changed the model by hand: the error is {ratio(now)}, before it was {then?.toFixed(1)}.</p>
        <div class="actions">
          <button type="button" class="main" onClick={() => void store.accept()}>Keep as a step</button>
          <button type="button" onClick={() => store.goTo(view.at)}>Discard</button>
        </div>
      </>
    );
  } else if (atNoise) {
    content = (
      <>
        <p class="answer good">Only noise is left{step && step.effects.length > 0 ? `: the model has ${listed(step.effects)}` : ""}. The error is {ratio(now)}.</p>
        <Exports />
        <Bar kind="rank" />
        {!diagnosis && !jobs.has("rank") && (
          <button type="button" onClick={() => void store.begin("rank")}>Search for further effects</button>
        )}
      </>
    );
  } else if (jobs.has("rank")) {
    content = (
      <>
        <p>The model misses by {ratio(now)}. Each effect is fitted together with the soil{candidate ? <>; most is gained by <b>{spoken(candidate)}</b></> : ""}.</p>
        <Bar kind="rank" />
        {candidate && <button type="button" class="main" onClick={() => store.toggle(candidate)}>Try {spoken(candidate)}</button>}
      </>
    );
  } else if (diagnosis || candidate) {
    content = (
      <>
        <p>The model misses by {ratio(now)}. {diagnosis ? verdict() : `Most is gained by ${spoken(candidate ?? "")}.`}</p>
        <div class="actions">
          {candidate && <button type="button" class="main" onClick={() => store.toggle(candidate)}>Try {spoken(candidate)}</button>}
          {find(candidate ? "Search again" : "Find what is missing")}
        </div>
      </>
    );
  } else {
    content = (
      <>
        <p class="answer">{now === null ? "The noise of this experiment is unknown." : `The calibrated model still misses by ${ratio(now)}: something is missing from it.`}</p>
        {find("Find what is missing")}
        <p class="hint">or switch an effect on by hand and watch the curves.</p>
      </>
    );
  }
  return (
    <section class="card guide" aria-labelledby="guide" aria-live="polite">
      <h2 id="guide" class="unseen">What to do next</h2>
      {experiment.example && view.at <= 1 && added.length === 0 && (
        <p class="hint">Example: a wheel on sand, measured at three loads and two speeds. Its model lacks one physical effect. Which?</p>
      )}
      {content}
    </section>
  );
}

/** What effects do to the error, in as many digits as tell the difference. */
function change(what: string, then: number | null, now: number | null): string {
  if (then === null || now === null) return `With ${what}; the noise of this experiment is unknown, so look at the curves.`;
  const digits = Math.abs(then - now) < 0.1 ? 2 : 1;
  const [before, after] = [then.toFixed(digits), now.toFixed(digits)];
  if (before === after) return `With ${what} the error stays at ${after} times the noise.`;
  return `With ${what} the error ${now < then ? "falls" : "rises"} from ${before} to ${after} times the noise.`;
}

function verdict(): string {
  const found = store.diagnosis;
  if (!found) return "";
  if (found.interrupted) return "The search was stopped before all was tried.";
  const tied = found.candidates.filter((one) => one.tied).map((one) => one.effect);
  if (found.verdict === "effect_missing") {
    const beside = found.possible_beside.length ? ` Perhaps ${found.possible_beside.map(spoken).join(" or ")} acts besides.` : "";
    return `Verdict: ${listed(found.effects.map(placed))} ${found.effects.length > 1 ? "are" : "is"} missing from the model.${beside}`;
  }
  if (found.verdict === "explained") return "Verdict: the calibrated model leaves only noise.";
  if (found.verdict === "undetermined") return tied.length ? `Verdict: open; ${listed(tied)} cannot be told apart here.` : "Verdict: open; this experiment cannot decide.";
  return found.effects.length ? `Verdict: ${listed(found.effects.map(placed))} explains a part only.` : "Verdict: something is missing that no known effect explains.";
}

/** An effect that a diagnosis names, with where it acts of several experiments. */
function placed(effect: string): string {
  const parts = store.diagnosis?.where?.[effect];
  return parts ? [effect, ...parts.map((part, k) => `${k ? "and" : "in"} ${part}`)].join(" ") : effect;
}

export function Exports() {
  const { experiment, part, diagnosis, listed: server, saved, step } = useStore();
  if (!experiment) return null;
  if (saved) {
    const toml = step?.toml;
    return toml ? (
      <div class="actions"><button type="button" onClick={() => give(new Blob([toml], { type: "application/toml" }), "model.toml")}>Save the model of this step (TOML)</button></div>
    ) : <p class="hint">This step has no model to save.</p>;
  }
  const out = (what: string, ending: string) => {
    const name = `${experiment.id}${part ? `-${part.part}` : ""}.${ending}`;
    void save(`api/experiments/${experiment.id}/export`, { what, values: store.values(), part: part?.part }, name).catch((error) => store.fail(error));
  };
  return (
    <div class="actions" role="group" aria-label={part ? `Save the model of ${part.part}` : "Save the model"}>
      {part && <p class="hint">Of <b>{part.part}</b>, the experiment that is shown:</p>}
      <button type="button" onClick={() => out("toml", "toml")}>Save model (TOML)</button>
      {server?.fmu && <button type="button" onClick={() => out("fmu", "fmu")}>Save FMU</button>}
      <button type="button" onClick={() => out("report", "html")}>Save report</button>
      {diagnosis && <button type="button" onClick={() => out("diagnosis", "html")}>Save page of the diagnosis</button>}
    </div>
  );
}

export function History() {
  const { steps, view } = useStore();
  if (steps.length === 0) return null;
  return (
    <section class="card" aria-labelledby="history">
      <h2 id="history">Steps</h2>
      <ol class="steps">
        {steps.map((step, at) => {
          const overall = store.overall(step.rmse);
          return (
            <li key={at}>
              <button type="button" aria-current={at === view.at ? "step" : undefined} onClick={() => store.goTo(at)}>
                <span>{step.label}</span>
                <span class="soft">{overall === null ? "" : `${times(overall)} noise`}</span>
              </button>
            </li>
          );
        })}
        {store.isChanged() && <li class="soft">{store.saved ? "changed by hand" : "changed, not accepted"}</li>}
      </ol>
      <button type="button" disabled={!canUndo()} onClick={() => history.back()}>Undo</button>
    </section>
  );
}

export function Next() {
  const { diagnosis, separation, jobs, experiment } = useStore();
  if (!experiment) return null;
  return (
    <section class="card" aria-labelledby="next">
      <h2 id="next">What experiment would decide</h2>
      {diagnosis && <Verdict />}
      {diagnosis?.suggestions.length ? (
        <ol>{diagnosis.suggestions.map((suggestion) => <li key={suggestion.text}>{suggestion.text}</li>)}</ol>
      ) : (
        <p class="soft">{diagnosis ? "Nothing has to be decided by another experiment." : "A search for the missing effect proposes one."}</p>
      )}
      {separation && (
        <>
          <p>What this experiment can tell apart, as it is:</p>
          <div class="scroll" tabIndex={0} role="region" aria-label="What can be told apart">
            <table>
              <thead><tr><th scope="col">effect</th><th scope="col">not absorbed by calibration</th><th scope="col">smallest strength that would be found</th></tr></thead>
              <tbody>
                {separation.effects.map((sight) => (
                  <tr key={sight.effect}>
                    <th scope="row">{spoken(sight.effect)}</th>
                    <td>{(100 * sight.visible_share).toFixed(0)} %</td>
                    <td>{sight.smallest.map((one) => (one.value === null ? "not within its bounds" : `${short(one.value)} ${one.unit === "1" ? "" : one.unit}`)).join(", ") || (sight.visible ? "visible" : "none")}</td>
                  </tr>
                ))}
              </tbody>
            </table>
          </div>
          {separation.pairs.some((pair) => pair.cosine > 0.8) && (
            <p>Look alike here: {separation.pairs.filter((pair) => pair.cosine > 0.8).map((pair) => listed(pair.effects)).join("; ")}.</p>
          )}
        </>
      )}
      {store.saved ? null : experiment.parts.length ? (
        <p class="hint">What one of them can tell apart, and what to measure next with its rig: <code>bekker studio</code> with that one alone.</p>
      ) : jobs.has("separate") ? <Bar kind="separate" /> : (
        <button type="button" onClick={() => void store.begin("separate")}>What can this experiment tell apart?</button>
      )}
    </section>
  );
}

function Verdict() {
  const { diagnosis } = useStore();
  if (!diagnosis) return null;
  return (
    <>
      <p><b>{verdict()}</b> It is about the model before {keyOf(diagnosis.effects) ? listed(diagnosis.effects) : "any effect"} was added.</p>
      {diagnosis.cautions.length > 0 && (
        <details>
          <summary>{diagnosis.cautions.length} cautions</summary>
          <ul>{diagnosis.cautions.map((caution) => <li key={caution}>{caution}</li>)}</ul>
        </details>
      )}
      {diagnosis.not_tried.length > 0 && <p class="soft">Not tried: {diagnosis.not_tried.join("; ")}.</p>}
    </>
  );
}
