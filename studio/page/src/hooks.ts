/** What parts of the page share. */

import { useEffect, useReducer, useState } from "preact/hooks";
import { store } from "./store";

/** Draws a part again whenever the state changes. */
export function useStore(): typeof store {
  const [, draw] = useReducer((n: number) => n + 1, 0);
  useEffect(() => store.subscribe(() => draw(undefined as never)), []);
  return store;
}

const dark = window.matchMedia("(prefers-color-scheme: dark)");

/** Whether the page is dark: as the system is. */
export function useDark(): boolean {
  const [is, set] = useState(dark.matches);
  useEffect(() => {
    const listen = () => set(dark.matches);
    dark.addEventListener("change", listen);
    return () => dark.removeEventListener("change", listen);
  }, []);
  return is;
}

export function isDark(): boolean {
  return dark.matches;
}

export function onTheme(draw: () => void): void {
  dark.addEventListener("change", draw);
}

/** Colours of groups that people with every kind of colour vision tell apart, for light and dark ground (after Okabe and Ito). */
const LIGHT = ["#0072b2", "#c24e00", "#00805a", "#a0468a", "#8a6d00", "#1a86c4", "#5c5c5c", "#b3261e"];
const DARK = ["#5ab4f0", "#ff9a52", "#3fc79a", "#e39ac8", "#e6cf5a", "#9ad0f5", "#b5b5b5", "#ff8a80"];

export function colour(group: number, dark: boolean): string {
  const all = dark ? DARK : LIGHT;
  return all[group % all.length] ?? "#888";
}

export function css(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
