/** Open experiments that are put together into a set, which is fitted at once. */

import { useRef, useState } from "preact/hooks";
import { post } from "./api";
import { useStore } from "./hooks";
import type { Kind, Listed } from "./types";

/** What several experiments may have in common, as the server calls it. */
const SHARED = [["soil", "the soil"], ["vehicle", "the wheel or the vehicle, with its drive"], ["drive", "motor and gear alone"]] as const;

const KINDS: Record<Kind, string> = { single_wheel: "a wheel on a carriage", traverse: "a rover on its way", plate_sinkage: "plates", shear: "shear tests" };

/** Scatter of the soil from one to the next where nothing is said, per cent. */
const USUAL_SCATTER = 5;

export function Together() {
  const { listed } = useStore();
  const dialog = useRef<HTMLDialogElement>(null);
  const singles = listed?.experiments.filter((one) => one.parts === 0) ?? [];
  if (singles.length < 2) return null;
  return (
    <>
      <button type="button" onClick={() => dialog.current?.showModal()}>Fit together…</button>
      <dialog ref={dialog} aria-labelledby="together">
        <h2 id="together">Fit several experiments together</h2>
        <p>What they share has one value for all of them; each keeps its rig and its noise. An effect that one alone hardly shows is seen sooner.</p>
        <Choice singles={singles} close={() => dialog.current?.close()} />
        <button type="button" onClick={() => dialog.current?.close()}>Close</button>
      </dialog>
    </>
  );
}

function Choice({ singles, close }: { singles: Listed["experiments"]; close: () => void }) {
  const store = useStore();
  const [left, leaveOut] = useState<string[]>([]);
  // What their folders say, or else the soil, until something is chosen.
  const [said, share] = useState<string[] | null>(null);
  const shared = said ?? ["soil"];
  const [scatter, setScatter] = useState(USUAL_SCATTER);
  const [error, setError] = useState("");
  const [busy, setBusy] = useState(false);
  const chosen = singles.filter(({ id }) => !left.includes(id));
  const turned = (all: string[], one: string) => (all.includes(one) ? all.filter((other) => other !== one) : [...all, one]);

  const open = async () => {
    setError("");
    setBusy(true);
    try {
      const request = { experiments: chosen.map(({ id }) => id), share: said, soil_scatter: scatter / 100 };
      const { id } = await post<{ id: string }>("api/sets", request);
      close();
      await store.openExperiment(id);
    } catch (reason) {
      setError(reason instanceof Error ? reason.message : String(reason));
    }
    setBusy(false);
  };

  return (
    <>
      {error && <p class="error" role="alert">{error}</p>}
      <fieldset>
        <legend>Experiments</legend>
        {singles.map(({ id, name, kind }) => (
          <label key={id} class="choice">
            <input type="checkbox" checked={!left.includes(id)} onChange={() => leaveOut(turned(left, id))} /> {name} <span class="soft">{KINDS[kind]}</span>
          </label>
        ))}
      </fieldset>
      <fieldset>
        <legend>They share</legend>
        {SHARED.map(([id, words]) => (
          <label key={id} class="choice">
            <input type="checkbox" checked={shared.includes(id)} onChange={() => share(turned(shared, id))} /> {words}
          </label>
        ))}
        <label class="choice">The soil differs from one to the next by{" "}
          <input type="number" class="cursor" min={0} max={50} step="any" disabled={!shared.includes("soil")} value={scatter}
            onChange={(event) => setScatter(Number(event.currentTarget.value))} /> %
        </label>
      </fieldset>
      <div class="actions">
        <button type="button" class="main" disabled={chosen.length < 2 || busy} onClick={() => void open()}>
          {busy ? "Opening…" : `Fit ${chosen.length} together`}
        </button>
      </div>
    </>
  );
}
