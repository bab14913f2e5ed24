(* A first-order lag is no worse than a delay: what follows with the time constant theta gets no faster than if all that was
   followed in the last theta acted together, the largest of it throughout. *)
Require Import Reals Lra Psatz.
From Coquelicot Require Import Coquelicot.
Require Import Motion.
Open Scope R_scope.

(* C4: x follows pull as a first-order lag with the time constant theta does. Without one it is pull. *)
Record lags (theta : R) (x pull : R -> R) : Prop := {
  constant : 0 <= theta;
  at_once : theta = 0 -> forall t, x t = pull t;
  late : 0 < theta -> forall t, is_derive x t ((pull t - x t) / theta)
}.

Definition rises_at_most (f : R -> R) (q t1 t2 : R) :=
  forall t t', t1 <= t -> t <= t' -> t' <= t2 -> f t' - f t <= q * (t' - t).

(* Who follows something that is below a line by the lag stays below the line. *)
Lemma stays_below_line theta x (pull : R -> R) L q t1 t2 :
  0 <= theta -> (theta = 0 -> forall t, t1 <= t -> x t = pull t) ->
  (0 < theta -> forall t, t1 <= t -> is_derive x t ((pull t - x t) / theta)) ->
  x t1 <= L -> (forall u, t1 <= u <= t2 -> pull u <= L + q * (u - t1) + theta * q) ->
  forall u, t1 <= u <= t2 -> x u <= L + q * (u - t1).
Proof.
  intros th0 once late_ x1 below u [lo hi].
  destruct (Req_dec theta 0) as [z | nz].
  { rewrite (once z u lo). pose proof (below u ltac:(lra)) as B. rewrite z in B. lra. }
  assert (th : 0 < theta) by lra. specialize (late_ th).
  set (g := fun s => exp ((s - t1) / theta) * (x s - L - q * (s - t1))).
  set (g' := fun s => exp ((s - t1) / theta) / theta * (pull s - L - q * (s - t1) - theta * q)).
  assert (D : forall s, t1 <= s -> is_derive g s (g' s)).
  { intros s h. unfold g, g'.
    assert (E : is_derive (fun s => exp ((s - t1) / theta)) s (exp ((s - t1) / theta) / theta)).
    { unfold Rdiv, Rminus. auto_derive; [trivial | ring]. }
    assert (F : is_derive (fun s => x s - L - q * (s - t1)) s ((pull s - x s) / theta - q)).
    { assert (F2 : is_derive (fun s => L + q * (s - t1)) s q) by (auto_derive; [trivial | ring]).
      pose proof (is_derive_minus x (fun s => L + q * (s - t1)) s _ _ (late_ s h) F2) as M.
      apply is_derive_ext with (2 := M). intros r. unfold minus, plus, opp. cbn. ring. }
    pose proof (is_derive_mult (fun s => exp ((s - t1) / theta)) (fun s => x s - L - q * (s - t1)) s _ _ E F
                  ltac:(intros; apply Rmult_comm)) as M.
    replace (exp ((s - t1) / theta) / theta * (pull s - L - q * (s - t1) - theta * q))
      with (plus (mult (exp ((s - t1) / theta) / theta) (x s - L - q * (s - t1)))
                 (mult (exp ((s - t1) / theta)) ((pull s - x s) / theta - q))); [exact M |].
    unfold plus, mult. cbn. field. lra. }
  assert (G : g u <= g t1).
  { destruct (Req_dec u t1) as [-> | ne]; [lra |].
    destruct (MVT_gen g t1 u g') as (c & [c1 c2] & eq).
    - intros s [a b]. rewrite Rmin_left in a by lra. apply D. lra.
    - intros s [a b]. rewrite Rmin_left in a by lra.
      apply continuity_pt_filterlim, (ex_derive_continuous g). exists (g' s). apply D. lra.
    - rewrite Rmin_left in c1 by lra. rewrite Rmax_right in c2 by lra.
      assert (g' c <= 0).
      { unfold g'. pose proof (exp_pos ((c - t1) / theta)). pose proof (below c ltac:(lra)).
        assert (0 < exp ((c - t1) / theta) / theta) by (apply Rdiv_lt_0_compat; lra).
        assert (0 <= exp ((c - t1) / theta) / theta * - (pull c - L - q * (c - t1) - theta * q)) by (apply Rmult_le_pos; lra).
        lra. }
      assert (g' c * (u - t1) <= 0) by nra. lra. }
  assert (g1 : g t1 <= 0).
  { unfold g. pose proof (exp_pos ((t1 - t1) / theta)). nra. }
  unfold g in G at 1. pose proof (exp_pos ((u - t1) / theta)).
  destruct (Rle_dec (x u) (L + q * (u - t1))) as [? | n]; [assumption | exfalso].
  assert (0 < exp ((u - t1) / theta) * (x u - L - q * (u - t1))) by (apply Rmult_lt_0_compat; lra). lra.
Qed.

(* The speed v changes as x does, but where it is c or less it may be held, until it is pulled away: the vehicle at rest
   (c = 0); or, with signs changed, the one that a limiter holds. Of the times at which it was held z is the last. *)
Definition goes_with (v x pull : R -> R) (c : R) :=
  forall t t', t <= t' -> v t' - v t <= x t' - x t \/
    exists z, t < z <= t' /\ v z <= c /\ pull z <= x z /\ v t' - v z <= x t' - x z /\ v t' - v t <= x t' - x z.

(* A bound on v that rises at least so fast. *)
Definition rises_at_least (f : R -> R) (q t1 t2 : R) :=
  forall t t', t1 <= t -> t <= t' -> t' <= t2 -> q * (t' - t) <= f t' - f t.

Section Envelope.
Variables (theta tau c T : R) (v x pull bound : R -> R).
Hypothesis lag : lags theta x pull.
Hypothesis no_longer : theta <= tau.
Hypothesis goes : goes_with v x pull c.
Hypothesis above : forall u, T <= u -> Rmin c (bound T) <= bound u.

(* From t1 to t2 the bound rises at q or faster, and nothing that was followed from tau before t1 on is more than q; nor, if
   that begins before T, is the acceleration at T. *)
Record piece (q t1 t2 : R) : Prop := {
  in_order : T <= t1 <= t2;
  followed : forall t t', T <= t -> t1 - tau <= t -> t <= t' -> t' <= t2 -> pull t' - pull t <= q * (t' - t);
  had : t1 - tau < T -> pull T - x T <= theta * q;
  bounds : rises_at_least bound q t1 t2
}.

(* Pieces, one after the other. *)
Inductive pieces : R -> R -> Prop :=
  | no_piece t : T <= t -> pieces t t
  | one_more q t1 t2 t3 : piece q t1 t2 -> pieces t2 t3 -> pieces t1 t3.

(* From p on, at the speed V there: [a0] is the acceleration at p. *)
Section From.
Variables (p V a0 : R).
Hypothesis after : T <= p.
Hypothesis starts : pull p - x p = theta * a0.
Hypothesis slow : V <= bound p.
Let y s := V + x s - x p.
Let P s := if Rlt_dec s p then V + theta * a0 + a0 * (s - p) else V + pull s - x p.

(* At p nothing is pulled harder than in any piece that begins soon after it; or it starts from rest there. *)
Hypothesis calm : (p = T) \/ (V <= Rmin c (bound T) /\ theta * a0 <= 0).

Let holds u := y u <= bound u /\ P (u - theta) <= bound u.

Lemma th0 : 0 <= theta.
Proof. apply lag. Qed.

Lemma P_after s : p <= s -> P s = V + pull s - x p.
Proof. intros. unfold P. destruct (Rlt_dec s p); [lra | reflexivity]. Qed.

Lemma P_before s : s <= p -> P s = V + theta * a0 + a0 * (s - p).
Proof.
  intros. destruct (Req_dec s p) as [-> | ne].
  - rewrite P_after by lra. lra.
  - unfold P. destruct (Rlt_dec s p); [reflexivity | lra].
Qed.

Lemma holds_at_first : holds p.
Proof.
  unfold holds, y. split; [lra |]. pose proof th0. rewrite P_before by lra.
  replace (V + theta * a0 + a0 * (p - theta - p)) with V by ring. exact slow.
Qed.

Lemma follows_y t1 t2 q : p <= t1 -> holds t1 -> rises_at_least bound q t1 t2 ->
  rises_at_most P q (t1 - theta) t2 -> forall u, t1 <= u <= t2 -> holds u.
Proof.
  intros p1 [y1 P1] rise up u [lo hi]. pose proof th0.
  assert (late_ : forall s, t1 <= s <= t2 -> P (s - theta) <= bound t1 + q * (s - t1)).
  { intros s [? ?]. pose proof (up (t1 - theta) (s - theta) ltac:(lra) ltac:(lra) ltac:(lra)) as U.
    replace (s - theta - (t1 - theta)) with (s - t1) in U by ring. lra. }
  pose proof (rise t1 u ltac:(lra) ltac:(lra) ltac:(lra)).
  split; [| pose proof (late_ u ltac:(lra)); lra].
  assert (y u <= bound t1 + q * (u - t1)); [| lra].
  apply stays_below_line with (theta := theta) (pull := P) (t2 := t2); auto; try lra.
  - intros z s h. unfold y. rewrite (P_after s ltac:(lra)), (at_once _ _ _ lag z s). lra.
  - intros pos s h. unfold y. rewrite (P_after s ltac:(lra)).
    assert (K : is_derive (fun _ => V - x p) s 0) by (apply (is_derive_const (V - x p))).
    pose proof (is_derive_plus (fun _ => V - x p) x s _ _ K (late _ _ _ lag pos s)) as M.
    apply is_derive_ext with (f := fun r => plus (V - x p) (x r)).
    + intros r. unfold plus. cbn. ring.
    + replace ((V + pull s - x p - (V + x s - x p)) / theta) with (plus 0 ((pull s - x s) / theta)); [exact M |].
      unfold plus. cbn. field. lra.
  - intros s [? ?]. pose proof (late_ s ltac:(lra)).
    pose proof (up (s - theta) s ltac:(lra) ltac:(lra) ltac:(lra)) as U. replace (s - (s - theta)) with theta in U by ring. lra.
Qed.

(* What was followed before p counts as the acceleration there. *)
Lemma P_rises q t1 t2 from : piece q t1 t2 -> t1 <= from -> p <= from -> (from - theta < p -> a0 <= q) ->
  rises_at_most P q (from - theta) t2.
Proof.
  intros [[? ?] fol _ _] le pf early s s' s1 s2 s3.
  destruct (Rle_dec p s) as [a | b].
  - rewrite !P_after by lra. pose proof (fol s s' ltac:(lra) ltac:(lra) ltac:(lra) ltac:(lra)). lra.
  - assert (aq : a0 <= q) by (apply early; lra).
    destruct (Rle_dec s' p) as [a' | b'].
    + rewrite !P_before by lra. assert (a0 * (s' - s) <= q * (s' - s)) by (apply Rmult_le_compat_r; lra). lra.
    + rewrite (P_before s), (P_after s') by lra.
      pose proof (fol p s' ltac:(lra) ltac:(lra) ltac:(lra) ltac:(lra)).
      assert (a0 * (p - s) <= q * (p - s)) by (apply Rmult_le_compat_r; lra). lra.
Qed.

Lemma through_piece q t1 t2 from : piece q t1 t2 -> t1 <= from -> p <= from -> holds from ->
  forall u, from <= u <= t2 -> holds u.
Proof.
  intros pc le pf H u [lo hi]. pose proof th0. pose proof (bounds _ _ _ pc) as rise.
  assert (rest_ : forall w, from <= w -> rises_at_least bound q w t2) by (intros w ? a b ? ? ?; apply rise; lra).
  destruct (Rle_dec a0 q) as [calm_ | pulled].
  { apply follows_y with from t2 q; auto; [apply rest_; lra |]. apply P_rises with t1; auto. }
  destruct calm as [e | [Vc a00]].
  - (* At T nothing pulls harder than in the pieces that begin soon. *)
    apply follows_y with from t2 q; auto; [apply rest_; lra |]. apply P_rises with t1; auto.
    intros soon. exfalso. assert (th : 0 < theta) by lra.
    pose proof (had _ _ _ pc ltac:(lra)) as h. rewrite <- e, starts in h.
    assert (theta * q < theta * a0) by (apply Rmult_lt_compat_l; lra). lra.
  - (* It starts from rest. *)
    assert (first : forall w, from <= w <= t2 -> w <= p + theta -> holds w).
    { intros w [? ?] ?. destruct (Req_dec theta 0) as [z | nz].
      { assert (w = from) by lra. subst w. exact H. }
      assert (a0 <= 0) by nra.
      pose proof (above w ltac:(lra)).
      split.
      - assert (y w <= V + 0 * (w - p)); [| lra].
        apply stays_below_line with (theta := theta) (pull := P) (t2 := w); auto; try lra; try (unfold y; lra).
        + intros pos s h. unfold y. rewrite (P_after s ltac:(lra)).
          assert (K : is_derive (fun _ => V - x p) s 0) by (apply (is_derive_const (V - x p))).
          pose proof (is_derive_plus (fun _ => V - x p) x s _ _ K (late _ _ _ lag pos s)) as M.
          apply is_derive_ext with (f := fun r => plus (V - x p) (x r)).
          * intros r. unfold plus. cbn. ring.
          * replace ((V + pull s - x p - (V + x s - x p)) / theta) with (plus 0 ((pull s - x s) / theta)); [exact M |].
            unfold plus. cbn. field. lra.
        + intros s [? ?]. rewrite P_after by lra.
          destruct (Rle_dec t1 p) as [e1 | e1].
          * pose proof (followed _ _ _ pc p s ltac:(lra) ltac:(lra) ltac:(lra) ltac:(lra)). nra.
          * pose proof (followed _ _ _ pc p s ltac:(lra) ltac:(lra) ltac:(lra) ltac:(lra)). nra.
      - rewrite P_before by lra. nra. }
    destruct (Rle_dec u (p + theta)) as [soon | later]; [apply first; lra |].
    set (w := Rmax from (p + theta)).
    assert (W : from <= w /\ p + theta <= w /\ w <= u) by (unfold w; cases; lra).
    assert (holds w).
    { unfold w. destruct (Rmax_spec from (p + theta)) as [[? ->] | [? ->]]; [apply first; lra | exact H]. }
    apply follows_y with w t2 q; auto; try lra; [apply rest_; lra |]. apply P_rises with t1; auto; try lra.
Qed.

Lemma through_pieces t1 t2 : pieces t1 t2 -> forall from, t1 <= from -> p <= from -> holds from ->
  forall u, from <= u <= t2 -> holds u.
Proof.
  induction 1 as [t le | q t1 t2 t3 pc rest_ IH]; intros from lo pf H u [u1 u2].
  - assert (u = from) by lra. subst u. exact H.
  - destruct (Rle_dec from t2) as [within | beyond].
    + destruct (Rle_dec u t2) as [? | ?]; [apply through_piece with q t1 t2 from; auto |].
      apply IH with t2; try lra. apply through_piece with q t1 t2 from; auto; lra.
    + apply IH with from; auto; lra.
Qed.
End From.

(* The speed stays below the bound. *)
Theorem lag_is_a_delay E : pieces T E -> v T <= bound T -> forall u, T <= u <= E -> v u <= bound u.
Proof.
  intros all v0 u [lo hi]. pose proof (constant _ _ _ lag) as th.
  assert (acc : forall p, exists a0, pull p - x p = theta * a0).
  { intros p. destruct (Req_dec theta 0) as [z | nz].
    - exists 0. rewrite (at_once _ _ _ lag z p). lra.
    - exists ((pull p - x p) / theta). field. exact nz. }
  destruct (goes T u lo) as [on | (z & [z1 z2] & vz & rest_ & on & on0)].
  - destruct (acc T) as [a0 A].
    destruct (through_pieces T (v T) a0 ltac:(lra) A ltac:(auto) T E all T ltac:(lra) ltac:(lra)
                (holds_at_first T (v T) a0 A v0) u ltac:(lra)) as [Y _]. lra.
  - destruct (acc z) as [a0 A]. pose proof (above z ltac:(lra)).
    set (V := Rmin (v z) (v T)).
    assert (VV : V <= v z /\ V <= v T) by (split; [apply Rmin_l | apply Rmin_r]).
    assert (Vc : V <= Rmin c (bound T)) by (apply Rmin_glb; lra).
    destruct (through_pieces z V a0 ltac:(lra) A ltac:(right; split; [exact Vc | lra]) T E all z ltac:(lra) ltac:(lra)
                (holds_at_first z V a0 A ltac:(lra)) u ltac:(lra)) as [Y _].
    assert (v u - V <= x u - x z); [| lra].
    unfold V. destruct (Rmin_spec (v z) (v T)) as [[_ ->] | [_ ->]]; lra.
Qed.
End Envelope.
