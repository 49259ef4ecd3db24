import { forgetInks } from './map/inks';

// Light or dark as the system says, until the operator chooses; the choice stays on this computer.

const kName = 'wayfuse-theme';
const dark = matchMedia('(prefers-color-scheme: dark)');

export function isDark(): boolean {
  return document.documentElement.dataset.theme === 'dark';
}

export function applyTheme(): void {
  const chosen = localStorage.getItem(kName) ?? (dark.matches ? 'dark' : 'light');
  document.documentElement.dataset.theme = chosen;
  forgetInks();
}

export function switchTheme(): void {
  const next = isDark() ? 'light' : 'dark';
  if (next === (dark.matches ? 'dark' : 'light')) localStorage.removeItem(kName);
  else localStorage.setItem(kName, next);
  applyTheme();
}

dark.addEventListener('change', applyTheme);
