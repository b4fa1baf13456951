/** Opening files: a folder with `experiment.toml`, or CSV files whose columns are mapped by choosing. */

import { useEffect, useRef, useState } from "preact/hooks";
import { post, put } from "./api";
import { planOf } from "./plan";
import { store } from "./store";
import type { Meaning, Proposal } from "./types";

interface Named { path: string; file: File }

/** Files of a drop, with those of folders. */
async function dropped(items: DataTransferItemList): Promise<Named[]> {
  const found: Named[] = [];
  const walk = async (entry: FileSystemEntry, path: string): Promise<void> => {
    if (entry.isFile) {
      const file = await new Promise<File>((take, fail) => (entry as FileSystemFileEntry).file(take, fail));
      found.push({ path: path + entry.name, file });
      return;
    }
    const reader = (entry as FileSystemDirectoryEntry).createReader();
    for (;;) {
      const some = await new Promise<FileSystemEntry[]>((take, fail) => reader.readEntries(take, fail));
      if (some.length === 0) return;
      for (const one of some) await walk(one, `${path}${entry.name}/`);
    }
  };
  const entries = [...items].map((item) => item.webkitGetAsEntry()).filter((entry) => entry !== null);
  for (const entry of entries) await walk(entry, "");
  return found;
}

/** Leaves out what is no table, and the name of a folder in which everything lies. */
function cleaned(files: Named[]): Named[] {
  const wanted = files.filter(({ path }) => /\.(csv|tsv|txt|dat|toml)$/i.test(path) && !path.split("/").some((part) => part.startsWith(".")));
  const folder = wanted.find(({ path }) => /(^|\/)experiment\.toml$/.test(path));
  const top = folder ? folder.path.slice(0, -"experiment.toml".length) : "";
  return wanted.filter(({ path }) => path.startsWith(top)).map(({ path, file }) => ({ path: path.slice(top.length), file }));
}

export function Opening() {
  const dialog = useRef<HTMLDialogElement>(null);
  const [state, setState] = useState<"choose" | "busy" | "map">("choose");
  const [number, setNumber] = useState(0);
  const [proposal, setProposal] = useState<Proposal | null>(null);
  const [settings, setSettings] = useState("");
  /** The settings as they are, also between two drawings of the page. */
  const text = useRef("");
  const changes = useRef(Promise.resolve());
  const [error, setError] = useState("");

  const failed = (reason: unknown) => setError(reason instanceof Error ? reason.message : String(reason));

  const open = async (upload: number, own: string | null) => {
    const opened = await post<{ id: string }>(`api/uploads/${upload}/open`, own === null ? {} : { settings: own });
    dialog.current?.close();
    setState("choose");
    await store.openExperiment(opened.id);
  };

  const take = async (all: Named[]) => {
    const plan = all.length === 1 && /\.(json|html)$/i.test(all[0]?.path ?? "") ? all[0] : undefined;
    setError("");
    if (plan) {
      try {
        store.plan = planOf(plan.path, await plan.file.text());
        dialog.current?.close();
        store.changed();
        setTimeout(() => document.getElementById("plan")?.scrollIntoView());
      } catch (reason) {
        if (!dialog.current?.open) dialog.current?.showModal();
        failed(reason);
      }
      return;
    }
    const files = cleaned(all);
    if (!dialog.current?.open) dialog.current?.showModal();
    if (files.length === 0) return setError("None of these is a CSV file or an experiment.toml.");
    setState("busy");
    try {
      const { upload } = await post<{ upload: number }>("api/uploads");
      setNumber(upload);
      for (const { path, file } of files) await put(`api/uploads/${upload}/files?path=${encodeURIComponent(path)}`, file);
      const proposed = await post<Proposal>(`api/uploads/${upload}/proposal`);
      if (proposed.ready) return await open(upload, null);
      setProposal(proposed);
      setSettings((text.current = proposed.settings));
      setState("map");
    } catch (reason) {
      failed(reason);
      setState("choose");
    }
  };

  /** Changes go to the server one after the other; the last answer says what the settings are. */
  const change = (request: unknown) => {
    setError("");
    const wanted = (changes.current = changes.current.then(async () => {
      try {
        const proposed = await post<Proposal>(`api/uploads/${number}/proposal`, request);
        setProposal(proposed);
        if (changes.current === wanted) setSettings((text.current = proposed.settings));
      } catch (reason) {
        failed(reason);
      }
    }));
    return wanted;
  };

  /** Opens with the settings that follow from all changes so far. */
  const openMapped = async () => {
    setError("");
    await changes.current;
    await open(number, text.current).catch(failed);
  };

  useEffect(() => {
    const over = (event: DragEvent) => event.preventDefault();
    const drop = (event: DragEvent) => {
      event.preventDefault();
      if (event.dataTransfer) void dropped(event.dataTransfer.items).then(take);
    };
    document.addEventListener("dragover", over);
    document.addEventListener("drop", drop);
    return () => {
      document.removeEventListener("dragover", over);
      document.removeEventListener("drop", drop);
    };
  });

  const picked = (event: Event & { currentTarget: HTMLInputElement }) => {
    const files = [...(event.currentTarget.files ?? [])].map((file) => ({ path: file.webkitRelativePath || file.name, file }));
    event.currentTarget.value = "";
    void take(files);
  };

  return (
    <>
      <button type="button" onClick={() => dialog.current?.showModal()}>Open files…</button>
      <dialog ref={dialog} aria-labelledby="opening">
        <h2 id="opening">Open an experiment</h2>
        {error && <p class="error" role="alert">{error}</p>}
        {state === "busy" && <p>Reading…</p>}
        {state === "choose" && (
          <>
            <p>Drop a folder with an <code>experiment.toml</code>, or CSV files, anywhere on the page, or choose them here. The page or the JSON of <code>bekker plan</code> shows the map of the plan. All stays on this machine.</p>
            <div class="actions">
              <label class="file">CSV files <input type="file" multiple accept=".csv,.tsv,.txt,.dat,.toml,.json,.html" onChange={picked} /></label>
              <label class="file">A folder <input type="file" {...{ webkitdirectory: true }} onChange={picked} /></label>
            </div>
          </>
        )}
        {state === "map" && proposal && (
          <Mapping proposal={proposal} settings={settings} onSettings={(own) => setSettings((text.current = own))} onChange={change}
            onOpen={() => void openMapped()} />
        )}
        <button type="button" onClick={() => { dialog.current?.close(); setState("choose"); setError(""); }}>Close</button>
      </dialog>
    </>
  );
}

interface MappingProperties {
  proposal: Proposal;
  settings: string;
  onSettings: (text: string) => void;
  onChange: (request: unknown) => Promise<void>;
  onOpen: () => void;
}

/** `"wheel.radius" under [parameters], m` asks for a number. */
function asked(missing: string): { name: string; unit: string } | null {
  const found = /^"?([\w.[\]]+)"? under \[(?:parameters|inputs)\](?:, (.*))?$/.exec(missing);
  return found?.[1] ? { name: found[1], unit: found[2] ?? "" } : null;
}

interface TypedProperties {
  value: string;
  /** Takes what was typed, once the hand leaves the field. */
  onTyped: (text: string) => Promise<void>;
  label: string;
  [attribute: string]: unknown;
}

/** A text field that keeps what is being typed while answers to other fields come and draw the page again. */
function Typed({ value, onTyped, label, ...others }: TypedProperties) {
  const [draft, setDraft] = useState<string | null>(null);
  const take = async (typed: string) => {
    await onTyped(typed);
    setDraft((now) => (now === typed ? null : now));
  };
  return (
    <input {...others} aria-label={label} value={draft ?? value} onInput={(event) => setDraft(event.currentTarget.value)}
      onChange={(event) => void take(event.currentTarget.value)} />
  );
}

function Mapping({ proposal, settings, onSettings, onChange, onOpen }: MappingProperties) {
  const put = (name: string, meaning: Meaning | null) => onChange({ columns: { [name]: meaning } });
  const open = proposal.missing.map((missing) => ({ missing, number: asked(missing) }));
  return (
    <>
      <div class="controls">
        <label>What was measured{" "}
          <select value={proposal.kind} onChange={(event) => void onChange({ kind: event.currentTarget.value })}>
            <option value="single_wheel">a wheel on a carriage</option>
            <option value="traverse">a rover on its way</option>
            <option value="plate_sinkage">a plate pressed into soil</option>
            <option value="shear">a shear test of soil</option>
          </select>
        </label>
        {open.map(({ missing, number }) => number && (
          <label key={missing}>{number.name}{number.unit && `, ${number.unit}`}{" "}
            <input type="number" step="any" class="cursor" onChange={(event) => void onChange({ filled: { [number.name]: Number(event.currentTarget.value) } })} />
          </label>
        ))}
      </div>
      {open.filter(({ number }) => !number).map(({ missing }) => <p key={missing} class="hint">Missing: {missing}</p>)}
      <datalist id="targets">{proposal.targets.map(([name]) => <option key={name} value={name.replace("[k]", "[1]")} />)}</datalist>
      <div class="scroll" tabIndex={0} role="region" aria-label="Columns of the files">
        <table>
          <thead><tr><th scope="col">column</th><th scope="col">values</th><th scope="col">signal</th><th scope="col">unit</th><th scope="col">turn sign</th><th scope="col">note</th></tr></thead>
          <tbody>
            {proposal.columns.map((one) => {
              const meaning = one.meaning ?? { target: "", unit: null, turned: false };
              return (
                <tr key={one.name}>
                  <th scope="row">{one.name}</th>
                  <td class="soft">{one.examples.slice(0, 3).join("; ")}</td>
                  <td><Typed list="targets" label={`signal of column ${one.name}`} placeholder="left out" value={meaning.target}
                    onTyped={(text) => put(one.name, text.trim() ? { ...meaning, target: text.trim() } : null)} /></td>
                  <td><Typed label={`unit of column ${one.name}`} class="unit" placeholder="SI" disabled={!one.meaning} value={meaning.unit ?? ""}
                    onTyped={(text) => put(one.name, { ...meaning, unit: text.trim() || null })} /></td>
                  <td><input type="checkbox" aria-label={`turn the sign of column ${one.name}`} disabled={!one.meaning} checked={meaning.turned}
                    onChange={(event) => void put(one.name, { ...meaning, turned: event.currentTarget.checked })} /></td>
                  <td class="note soft">{one.note}</td>
                </tr>
              );
            })}
          </tbody>
        </table>
      </div>
      <details><summary>experiment.toml, which follows from these choices and can be edited</summary>
        <textarea rows={16} aria-label="experiment.toml" spellcheck={false} value={settings} onInput={(event) => onSettings(event.currentTarget.value)} />
      </details>
      <div class="actions"><button type="button" class="main" onClick={onOpen}>Open</button></div>
    </>
  );
}
