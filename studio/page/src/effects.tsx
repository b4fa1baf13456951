/** Effects with toggles and strengths, and what the ranking found of each. */

import { useEffect, useState } from "preact/hooks";
import { column, listed, quantity, short, spoken } from "./format";
import { useStore } from "./hooks";
import { families, placeOf, plainName } from "./set";
import { keyOf } from "./memory";
import { store } from "./store";
import type { Candidate, EffectInfo, Parameter } from "./types";

/** Parameters that a search shows. */
const MOST_FOUND = 8;

/** Values between which a slider moves evenly: in decades where a positive range spans them. */
const STEPS = 1000;

type Range = [number, number];

function isLogarithmic([low, high]: Range): boolean {
  return low > 0 && high / low >= 100;
}

function toPlace(range: Range, value: number): number {
  const [low, high] = range;
  const share = isLogarithmic(range) ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
  return Math.round(STEPS * share);
}

function toValue(range: Range, place: number): number {
  const [low, high] = range;
  const share = place / STEPS;
  const value = isLogarithmic(range) ? low * (high / low) ** share : low + share * (high - low);
  return Math.min(high, Math.max(low, Number(value.toPrecision(6))));
}

/** Whether a fit leaves a parameter of an effect at its neutral value, from which it starts: of its laws that one is not needed. */
function isOff(parameter: Parameter, value: number): boolean {
  return parameter.effect !== null && value === parameter.start;
}

export function Slider({ parameter, label }: { parameter: Parameter; label: string }) {
  const { experiment } = useStore();
  const value = store.value(parameter);
  const movable = store.range(parameter);
  const range: Range = movable ?? [parameter.min, parameter.max];
  const text = `${short(value * parameter.factor)}${parameter.unit ? ` ${parameter.unit}` : ""}`;
  const id = `p-${parameter.name.replaceAll(" ", "-")}`;
  const found = store.found.get(keyOf(store.view.on))?.fitted?.[parameter.name];
  const fitted = found && found.value === value ? found : parameter.fitted?.value === value ? parameter.fitted : null;
  return (
    <div class="slider" title={parameter.about}>
      <label for={id}>{label}</label>
      <output for={id}>
        {text}
        {fitted?.std != null && <span class="soft"> ± {short(fitted.std * parameter.factor)}</span>}
      </output>
      <input
        id={id}
        type="range"
        min={0}
        max={STEPS}
        value={toPlace(range, value)}
        aria-valuetext={text}
        disabled={!experiment || !movable}
        onInput={(event) => store.move(parameter.name, toValue(range, Number(event.currentTarget.value)))}
      />
      {fitted?.at_bound && <span class="flag">{isOff(parameter, fitted.value) ? "left off" : "on its bound"}</span>}
      {fitted && fitted.std === null && !fitted.at_bound && <span class="flag">not determined by this experiment</span>}
      {fitted?.prior_shift != null && Math.abs(fitted.prior_shift) > 2 && (
        <span class="flag">{short(fitted.prior_shift)} standard deviations from its prior</span>
      )}
    </div>
  );
}

/** Where an effect stands among all: an open circle while the search runs, a full one once it is judged. */
function Gain({ gain, most, candidate }: { gain: number | null; most: number; candidate: Candidate | undefined }) {
  if (gain === null) return <svg class="gain" viewBox="0 0 100 14" aria-hidden="true"><line x1="4" x2="96" y1="7" y2="7" /></svg>;
  const x = 5 + (90 * Math.sqrt(Math.max(gain, 0))) / Math.sqrt(Math.max(most, 1));
  return (
    <svg class="gain" viewBox="0 0 100 14" aria-hidden="true">
      <line x1="4" x2="96" y1="7" y2="7" />
      <circle cx={x} cy="7" r="4.5" class={candidate ? "judged" : "open"} />
    </svg>
  );
}

function words(candidate: Candidate | undefined, gain: number | null, best: boolean): string {
  if (!candidate) return gain === null ? "" : "tried, not judged yet";
  if (candidate.tied) return "cannot be told from others";
  const probability = candidate.probability;
  if (probability !== null && probability >= 0.005) return `probability ${(100 * probability).toFixed(0)} %`;
  return best ? "best single effect" : candidate.p_value > 0.05 ? "no more than noise" : "explained by others";
}

interface Row {
  /** The effect wherever it may act, and where it acts or would act first. */
  family: EffectInfo[];
  shown: EffectInfo;
  on: boolean;
}

/** A row for every place in which an effect acts; one for an effect that does not, where it would gain the most. */
function rowsOf(family: EffectInfo[], on: string[], gains: Map<string, number | null>): Row[] {
  const acting = family.filter(({ id }) => on.includes(id));
  if (acting.length) return acting.map((shown) => ({ family, shown, on: true }));
  const best = family.reduce((most, one) => ((gains.get(one.id) ?? 0) > (gains.get(most.id) ?? 0) ? one : most));
  return [{ family, shown: best, on: false }];
}

function Effect({ row, gains, most, best }: { row: Row; gains: Map<string, number | null>; most: number; best: string | undefined }) {
  const { diagnosis, whole } = useStore();
  const [chosen, choose] = useState("");
  const { family, on } = row;
  const shown = on ? row.shown : (family.find(({ id }) => id === chosen) ?? row.shown);
  const { id, about } = shown;
  const gain = gains.get(id) ?? null;
  const candidate = diagnosis?.candidates.find((one) => one.effect === id);
  const several = whole !== null && family.length > 1;
  const place = (elsewhere: string) => (on ? store.place(id, elsewhere) : choose(elsewhere));
  // What was chosen before is over once it has acted.
  useEffect(() => {
    if (on) choose("");
  }, [on]);
  const described = `about-${id.replaceAll(" ", "-")}`;
  return (
    <li class={on ? "effect on" : "effect"}>
      <label class="toggle">
        <input type="checkbox" role="switch" checked={on} disabled={!store.canToggle(id)} onChange={() => store.toggle(id)} aria-describedby={described} />
        <span class="name">{spoken(several ? shown.plain : id)}</span>
        <Gain gain={gain} most={most} candidate={candidate} />
      </label>
      {several && (
        <label class="where">
          <span class="unseen">Where {spoken(shown.plain)} acts</span>
          <select value={id} onChange={(event) => place(event.currentTarget.value)}>
            {family.map((one) => <option key={one.id} value={one.id}>{placeOf(one, whole)}</option>)}
          </select>
        </label>
      )}
      <p id={described} class="about">
        {about}
        {!several && whole !== null && whole.parts.length > 1 && shown.parts && <> Acts {placeOf(shown, whole)}.</>}
        {(candidate || gain !== null) && <em> {words(candidate, gain, id === best)}</em>}
      </p>
      {on && store.parametersOf(id).map((parameter) => (
        <Slider key={parameter.name} parameter={parameter} label={spoken(parameter.name.slice(id.length + 1))} />
      ))}
    </li>
  );
}

/** What is taken as known, and may be moved all the same to see what it does. */
function Known() {
  const { experiment, part, view } = useStore();
  const [search, setSearch] = useState("");
  const known = (experiment?.known ?? []).filter(({ parts }) => !part || !parts || parts.includes(part.part));
  if (known.length === 0) return null;
  const words = search.toLowerCase().split(/\s+/);
  const moved = known.filter(({ name }) => name in store.values());
  const found = search ? known.filter(({ name, about }) => words.every((word) => `${name} ${about}`.toLowerCase().replaceAll("_", " ").includes(word))) : [];
  const shown = [...new Set([...moved, ...found.slice(0, MOST_FOUND)])];
  return (
    <details class="card" open={moved.some(({ name }) => name in view.set) || undefined}>
      <summary><h2>What is taken as known</h2></summary>
      <p class="hint">Dimensions, masses and whatever else no calibration moves: {known.length} parameters{part && ` of ${part.part}`}.</p>
      <label>
        Find a parameter{" "}
        <input type="search" value={search} placeholder="radius" onInput={(event) => setSearch(event.currentTarget.value)} />
      </label>
      {found.length > MOST_FOUND && <p class="hint">{found.length - MOST_FOUND} more; say more of the name.</p>}
      {search && found.length === 0 && <p class="hint">No parameter is called so.</p>}
      {shown.map((parameter) => <Slider key={parameter.name} parameter={parameter} label={plainName(parameter)} />)}
    </details>
  );
}

/** How a saved page knows models between those that were simulated. */
function Interpolation() {
  const { experiment, saved } = useStore();
  const worst = saved?.worst();
  if (!experiment || !saved) return null;
  if (!worst) return <p class="hint">No effect was tried for this page; <code>bekker diagnose</code> and <code>bekker studio</code> try them.</p>;
  const shown = column(experiment, worst.signal);
  const { kept, of } = saved.rows;
  return (
    <p class="hint">
      In this file each effect was computed at a few strengths; between them the curves are interpolated. The largest difference from a
      simulation half way between, rounding included, is {quantity(worst.error, shown)} of {shown.name}
      {worst.ratio === null ? "" : `, ${short(worst.ratio)} times the noise of one measurement`} ({listed(worst.effects)}).
      {kept < of ? ` The plots show ${kept} of ${of} rows; errors are those of all.` : ""} <code>bekker studio</code> combines effects freely.
    </p>
  );
}

/** Rows keep their place in the page, and with it the keyboard's focus, where an effect comes to act elsewhere. */
function keyed(rows: Row[]): [string, Row][] {
  const count = new Map<string, number>();
  return rows.map((row) => {
    const { plain } = row.shown;
    const number = count.get(plain) ?? 0;
    count.set(plain, number + 1);
    return [`${plain} ${number}`, row];
  });
}

export function Effects() {
  const { experiment, view, jobs, diagnosis } = useStore();
  if (!experiment) return null;
  const accepted = store.accepted;
  const gains = new Map(experiment.effects.map(({ id }) => [id, accepted.includes(id) ? null : store.gain(id)]));
  const most = Math.max(1, ...[...gains.values()].map((gain) => gain ?? 0));
  const rank = ({ shown, on }: Row) => (on ? Number.POSITIVE_INFINITY : (gains.get(shown.id) ?? -1));
  // While a person moves a strength its row stays where it is: the order follows the gains only.
  const offered = experiment.effects.filter(({ id, shows }) => (shows && store.canToggle(id)) || view.on.includes(id));
  const sorted = families(offered).flatMap((family) => rowsOf(family, view.on, gains)).sort((p, q) => rank(q) - rank(p));
  const hidden = store.saved ? [] : experiment.effects.filter(({ id, plain, shows }) => !shows && id === plain);
  const unseen = (diagnosis?.invisible ?? []).filter((id) => !hidden.some((one) => one.id === id));
  const searching = jobs.has("rank");
  const shown = [...gains.values()].some((gain) => gain !== null);
  const best = [...gains.entries()].sort((p, q) => (q[1] ?? 0) - (p[1] ?? 0))[0]?.[0];
  return (
    <section class="card" aria-labelledby="effects">
      <h2 id="effects">Effects that the model may lack</h2>
      {shown && (
        <p class="hint">
          The circle shows how much of the misfit an effect removes when it is fitted together with the soil; farther right is more.
          {searching ? " Open circles are not judged yet." : ""}
        </p>
      )}
      <ul class="effects">
        {keyed(sorted).map(([key, row]) => <Effect key={key} row={row} gains={gains} most={most} best={best} />)}
      </ul>
      {store.saved && <Interpolation />}
      {hidden.length > 0 && (
        <details>
          <summary class="hint">{hidden.length} effects that cannot show in such an experiment</summary>
          <p class="hint">{hidden.map(({ id }) => spoken(id)).join(", ")}</p>
        </details>
      )}
      {unseen.length > 0 && <p class="hint">The search has found no trace of: {unseen.map(spoken).join(", ")}.</p>}
    </section>
  );
}

export function Parameters() {
  const { experiment, part, jobs, listed: server } = useStore();
  if (!experiment) return null;
  const base = store.parametersOf(null);
  const own = base.filter(({ parts }) => part && parts?.includes(part.part));
  const elsewhere = base.filter(({ parts }) => part && parts && !parts.includes(part.part));
  const others = (server?.experiments ?? []).filter((one) => one.id !== experiment.id);
  const fitting = jobs.has("fit");
  return (
    <>
    <details class="card" open={false}>
      <summary><h2>Soil and other calibrated parameters</h2></summary>
      {part && <h3>Shared by all experiments</h3>}
      {base.filter((one) => !own.includes(one) && !elsewhere.includes(one)).map((parameter) => (
        <Slider key={parameter.name} parameter={parameter} label={spoken(parameter.name)} />
      ))}
      {part && own.length > 0 && <h3>Of {part.part} alone</h3>}
      {own.map((parameter) => <Slider key={parameter.name} parameter={parameter} label={plainName(parameter)} />)}
      {elsewhere.length > 0 && <p class="hint">{elsewhere.length} more belong to the other experiments and show when these do.</p>}
      {experiment.calibration && (
        <p class="hint">
          ± is the standard error. {experiment.calibration.agreeing} of {experiment.calibration.searches} searches from different starts ended at the
          same error.
        </p>
      )}
      {!store.saved && others.length > 0 && (
        <label class="controls">
          Take the soil of{" "}
          <select value="" onChange={(event) => { const id = event.currentTarget.value; event.currentTarget.value = ""; if (id) void store.takeSoil(id); }}>
            <option value="">another experiment…</option>
            {others.map((one) => <option key={one.id} value={one.id}>{one.name}</option>)}
          </select>
        </label>
      )}
      {!store.saved && (
        <button type="button" disabled={!experiment.calibration || fitting} onClick={() => store.refit()}>
          {fitting ? "Fitting…" : "Fit all parameters again"}
        </button>
      )}
    </details>
    <Known />
    </>
  );
}
